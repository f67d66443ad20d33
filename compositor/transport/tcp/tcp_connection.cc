// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/tcp_connection.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <thread>

#include "compositor/transport/limits.h"
#include "compositor/transport/tcp/line_protocol.h"
#include "compositor/transport/tcp/tcp_socket.h"

namespace understudy::compositor {

namespace {

/// Shorter blocks are sent uncompressed.
constexpr std::size_t least_compressed = 512;
/// Shorter pieces share a record; longer ones are sealed without a copy.
constexpr std::size_t least_record = std::size_t(1) << 14;

/// The peer closed the connection before the handshake ended: a listener with too many pending clients may do
/// that, and may accept the next attempt.
class WentEarly : public HandshakeFailed {
 public:
  using HandshakeFailed::HandshakeFailed;
};

std::vector<std::byte> read_exactly(int socket, std::size_t size, Deadline deadline) {
  std::vector<std::byte> bytes(size);
  for (std::size_t have = 0; have < size;) {
    const ssize_t got = ::recv(socket, bytes.data() + have, size - have, MSG_DONTWAIT);
    if (got > 0) {
      have += std::size_t(got);
    } else if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
      throw WentEarly("it closed the connection without a word: look at host and port");
    } else if (Clock::now() >= deadline || !wait_until_ready(socket, POLLIN, deadline)) {
      throw HandshakeFailed("it says nothing: look at host and port");
    }
  }
  return bytes;
}

void write_all(int socket, std::span<const std::byte> bytes) {
  // A few hundred bytes at the beginning of a connection: they always fit.
  if (::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) != ssize_t(bytes.size()))
    throw WentEarly("it closed the connection without a word: look at host and port");
}

AuthenticatedSocket prove(const TcpAddress& address, const Credentials& credentials,
                          const ConnectionRequest& connection_request, Deadline deadline) {
  FileDescriptor socket = connect_to(address, deadline);
  if (connection_request.plain && !is_within_machine(socket.get()))
    throw std::runtime_error(
        fmt::format("--plain is for connections within one machine, and {} is another: leave --plain out, "
                    "and all is encrypted",
                    address.text()));
  ClientHandshake handshake(credentials, connection_request);
  write_all(socket.get(), handshake.hello());
  std::vector<std::byte> challenge = read_exactly(socket.get(), challenge_bytes, deadline);
  handshake.check(challenge);
  const std::vector<std::byte> key = read_exactly(socket.get(), server_key_bytes, deadline);
  challenge.insert(challenge.end(), key.begin(), key.end());
  write_all(socket.get(), handshake.answer(challenge));
  handshake.finish(read_exactly(socket.get(), verdict_bytes, deadline));
  return {std::move(socket), handshake.session_keys()};
}

}  // namespace

AuthenticatedSocket connect_tcp(const TcpAddress& address, const Credentials& credentials,
                                const ConnectionRequest& connection_request, Deadline deadline) {
  constexpr int tries = 5;
  for (int attempt = 1;; ++attempt) {
    try {
      return prove(address, credentials, connection_request, deadline);
    } catch (const WentEarly& error) {
      if (attempt == tries || Clock::now() >= deadline)
        throw std::runtime_error(fmt::format("whoever listens at {}: {}", address.text(), error.what()));
      std::this_thread::sleep_for(std::chrono::milliseconds(20 * attempt));
    } catch (const HandshakeFailed& error) {
      throw std::runtime_error(fmt::format("whoever listens at {}: {}", address.text(), error.what()));
    }
  }
}

TcpConnection::TcpConnection(AuthenticatedSocket peer, Protocols spoken, std::uint64_t max_payload,
                             std::chrono::milliseconds patience)
    : socket_(std::move(peer.socket)), patience_(patience), reader_(spoken, max_payload) {
  if (!peer.keys) return;
  sealer_.emplace(peer.keys->send);
  opener_.emplace(peer.keys->receive);
  gathered_.reserve(max_record_bytes);
}

double TcpConnection::bytes_per_second() const {
  return line_figures(socket_.get()).bytes_per_second;
}

bool TcpConnection::peer_is_silent() const {
  if (Clock::now() < heard_at_.load() + patience_) return false;
  // Bytes that have arrived and were not read yet count, too.
  return !wait_until_ready(socket_.get(), POLLIN, Clock::now());
}

void TcpConnection::give_up_silent_line() const {
  throw ConnectionAbandoned(
      fmt::format("its other end has said nothing for {} s: the line is cut, or the machine there stands still",
                  std::chrono::duration<double>(patience_).count()));
}

void TcpConnection::wait_for_room() {
  const Deadline begun = Clock::now();
  bool was_silent = false;
  while (!wait_until_ready(socket_.get(), POLLOUT, Clock::now() + patience_ / 4)) {
    // A single time may lie between another thread's reading and its update of heard_at_.
    const bool silent = peer_is_silent();
    if (silent && was_silent) give_up_silent_line();
    was_silent = silent;
    if (Clock::now() >= begun + limits::server_patience)
      throw ConnectionAbandoned("its other end does not read what it is sent: whoever it is for stands still");
  }
}

void TcpConnection::write(std::span<const Bytes> pieces, bool more) {
  if (sealer_)
    write_records(pieces, more);
  else
    write_as_they_are(pieces, more);
}

/// One record is sent while the next one is sealed.
void TcpConnection::write_records(std::span<const Bytes> pieces, bool more) {
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const bool more_pieces = more || i + 1 < pieces.size();
    Bytes piece = pieces[i];
    if (piece.size() >= least_record) write_gathered(true);
    while (piece.size() >= least_record) {
      const Bytes some = piece.first(std::min(piece.size(), max_record_bytes));
      piece = piece.subspan(some.size());
      const Bytes record = sealer_->seal(some);
      write_as_they_are({&record, 1}, more_pieces || !piece.empty());
    }
    if (gathered_.size() + piece.size() > max_record_bytes) write_gathered(true);
    gathered_.insert(gathered_.end(), piece.begin(), piece.end());
  }
  if (!more) write_gathered(false);
}

void TcpConnection::write_gathered(bool more) {
  if (gathered_.empty()) return;
  const Bytes record = sealer_->seal(gathered_);
  write_as_they_are({&record, 1}, more);
  gathered_.clear();
}

void TcpConnection::write_as_they_are(std::span<const Bytes> pieces, bool more) {
  std::vector<iovec> left;
  // sendmsg() takes pointers to non-const, but does not write.
  for (const Bytes& piece : pieces)
    if (!piece.empty()) left.push_back({const_cast<std::byte*>(piece.data()), piece.size()});
  msghdr message{};
  message.msg_iov = left.data();
  message.msg_iovlen = left.size();
  while (message.msg_iovlen > 0) {
    const ssize_t sent =
        ::sendmsg(socket_.get(), &message, MSG_NOSIGNAL | MSG_DONTWAIT | (more ? int(MSG_MORE) : 0));
    if (sent < 0) {
      if (errno == EINTR) continue;
      if (errno != EAGAIN && errno != EWOULDBLOCK)
        throw ConnectionLost(fmt::format("lost the connection: {}", std::strerror(errno)));
      wait_for_room();
      continue;
    }
    sent_at_ = Clock::now();
    sent_.bytes += std::size_t(sent);
    for (std::size_t gone = std::size_t(sent); message.msg_iovlen > 0;) {
      iovec& piece = *message.msg_iov;
      if (gone < piece.iov_len) {
        piece.iov_base = static_cast<std::byte*>(piece.iov_base) + gone;
        piece.iov_len -= gone;
        break;
      }
      gone -= piece.iov_len;
      ++message.msg_iov;
      --message.msg_iovlen;
    }
  }
}

void TcpConnection::send_block(MessageType type, Bytes block, bool last) {
  CodecChoice& choice = choices_[{type.protocol, type.number}];
  Codec codec = block.size() < least_compressed ? Codec::none : choice.best(bytes_per_second());
  Bytes travels = block;
  if (codec != Codec::none) {
    const auto start = Clock::now();
    const bool shorter = compressor_.compress(codec, block, compressed_);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    choice.note(codec, block.size(), shorter ? compressed_.size() : block.size(), seconds);
    if (shorter)
      travels = compressed_;
    else
      codec = Codec::none;
  } else if (block.size() >= least_compressed) {
    choice.note(Codec::none, block.size(), block.size(), 0);
  }
  ++sent_.blocks[std::size_t(codec)];
  const BlockHead head = BlockHead::of(block.size(), travels.size(), codec);
  const std::array<Bytes, 2> pieces = {std::as_bytes(std::span(&head, 1)), travels};
  write(pieces, !last);
}

void TcpConnection::begin(MessageType type, std::uint64_t sequence, std::uint64_t payload_bytes) {
  MessageHeader header;
  header.type = type;
  header.sequence = sequence;
  header.payload_bytes = payload_bytes;
  const Bytes head = std::as_bytes(std::span(&header, 1));
  write({&head, 1}, payload_bytes > 0);
  begun_ = type;
  begun_left_ = payload_bytes;
  ++sent_.messages;
  sent_.payload_bytes += payload_bytes;
}

void TcpConnection::send_payload(Bytes some) {
  while (!some.empty()) {
    const Bytes block = some.first(std::min(some.size(), limits::max_tcp_block_bytes));
    some = some.subspan(block.size());
    begun_left_ -= block.size();
    send_block(begun_, block, begun_left_ == 0);
  }
}

void TcpConnection::send(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts) {
  std::uint64_t payload_bytes = 0;
  for (const Bytes& part : parts) payload_bytes += part.size();
  begin(type, sequence, payload_bytes);
  for (const Bytes& part : parts) send_payload(part);
}

void TcpConnection::send_alive() {
  MessageHeader header;
  header.type = LineMessage::alive;
  const BlockHead nothing;
  const Bytes words =
      begun_left_ > 0 ? std::as_bytes(std::span(&nothing, 1)) : std::as_bytes(std::span(&header, 1));
  write({&words, 1}, false);
}

std::span<std::byte> TcpConnection::room() {
  return opener_ ? opener_->room() : reader_.room();
}

std::optional<Message> TcpConnection::took(std::size_t count) {
  if (!opener_) return reader_.took(count);
  if (!opener_->took(count)) return std::nullopt;
  const std::size_t plain = opener_->plain_bytes();
  // Records within a block are opened in place.
  if (const std::span<std::byte> place = reader_.room(); plain <= place.size()) {
    opener_->open(place.first(plain));
    return plain == 0 ? std::nullopt : reader_.took(plain);
  }
  opened_.resize(plain);
  taken_ = 0;
  opener_->open(opened_);
  return take_opened();
}

std::optional<Message> TcpConnection::take_opened() {
  while (taken_ < opened_.size()) {
    const std::span<std::byte> place = reader_.room();
    const std::size_t count = std::min(place.size(), opened_.size() - taken_);
    std::copy_n(opened_.begin() + std::ptrdiff_t(taken_), count, place.begin());
    taken_ += count;
    if (std::optional<Message> message = reader_.took(count)) return message;
  }
  return std::nullopt;
}

Message TcpConnection::receive() {
  for (;;) {
    std::optional<Message> message = take_opened();
    if (!message) {
      const std::span<std::byte> to = room();
      const ssize_t got = ::recv(socket_.get(), to.data(), to.size(), MSG_DONTWAIT);
      if (got > 0) {
        heard_at_ = Clock::now();
        received_.bytes += std::size_t(got);
        message = took(std::size_t(got));
      } else if (got == 0) {
        throw ConnectionLost("closed the connection");
      } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
        if (!wait_until_ready(socket_.get(), POLLIN, heard_at_.load() + patience_)) give_up_silent_line();
      } else if (errno != EINTR) {
        throw ConnectionLost(fmt::format("lost the connection: {}", std::strerror(errno)));
      }
    }
    if (!message || message->type == LineMessage::alive) continue;
    ++received_.messages;
    received_.payload_bytes += message->payload.size();
    return std::move(*message);
  }
}

}  // namespace understudy::compositor
