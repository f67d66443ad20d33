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

/// Shorter blocks travel as they are.
constexpr std::size_t least_compressed = 512;

/// The peer went before it had said all: a listener with too many pending clients may do that, and takes the
/// next try.
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
  // Some hundred bytes at the beginning of a connection: they always fit.
  if (::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) != ssize_t(bytes.size()))
    throw WentEarly("it closed the connection without a word: look at host and port");
}

FileDescriptor prove(const TcpAddress& address, const Secret& secret,
                     const ConnectionRequest& connection_request, Deadline deadline) {
  FileDescriptor socket = connect_to(address, deadline);
  ClientHandshake handshake(secret, connection_request);
  write_all(socket.get(), handshake.hello());
  write_all(socket.get(), handshake.answer(read_exactly(socket.get(), challenge_bytes, deadline)));
  handshake.finish(read_exactly(socket.get(), verdict_bytes, deadline));
  return socket;
}

}  // namespace

FileDescriptor connect_tcp(const TcpAddress& address, const Secret& secret,
                           const ConnectionRequest& connection_request, Deadline deadline) {
  constexpr int tries = 5;
  for (int attempt = 1;; ++attempt) {
    try {
      return prove(address, secret, connection_request, deadline);
    } catch (const WentEarly& error) {
      if (attempt == tries || Clock::now() >= deadline)
        throw std::runtime_error(fmt::format("whoever listens at {}: {}", address.text(), error.what()));
      std::this_thread::sleep_for(std::chrono::milliseconds(20 * attempt));
    } catch (const HandshakeFailed& error) {
      throw std::runtime_error(fmt::format("whoever listens at {}: {}", address.text(), error.what()));
    }
  }
}

double TcpConnection::bytes_per_second() const {
  return line_figures(socket_.get()).bytes_per_second;
}

bool TcpConnection::peer_is_silent() const {
  if (Clock::now() < heard_at_.load() + patience_) return false;
  // What has come and was not read yet has been said, too.
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
    // Once may be the moment between another thread's reading and its saying so.
    const bool silent = peer_is_silent();
    if (silent && was_silent) give_up_silent_line();
    was_silent = silent;
    if (Clock::now() >= begun + limits::server_patience)
      throw ConnectionAbandoned("its other end does not read what it is sent: whoever it is for stands still");
  }
}

void TcpConnection::write(std::span<const Bytes> pieces, bool more) {
  std::vector<iovec> left;
  // sendmsg() takes pointers to non-const and does not write.
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

Message TcpConnection::receive() {
  for (;;) {
    const std::span<std::byte> room = reader_.room();
    const ssize_t got = ::recv(socket_.get(), room.data(), room.size(), MSG_DONTWAIT);
    if (got > 0) {
      heard_at_ = Clock::now();
      received_.bytes += std::size_t(got);
      if (std::optional<Message> message = reader_.took(std::size_t(got));
          message && message->type != LineMessage::alive) {
        ++received_.messages;
        received_.payload_bytes += message->payload.size();
        return std::move(*message);
      }
    } else if (got == 0) {
      throw ConnectionLost("closed the connection");
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (!wait_until_ready(socket_.get(), POLLIN, heard_at_.load() + patience_)) give_up_silent_line();
    } else if (errno != EINTR) {
      throw ConnectionLost(fmt::format("lost the connection: {}", std::strerror(errno)));
    }
  }
}

}  // namespace understudy::compositor
