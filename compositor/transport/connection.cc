// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/connection.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace understudy::compositor {

namespace {

// One call of receive_some() reads at most this much.
constexpr std::size_t fair_share = std::size_t(8) << 20;

// Keeps the first descriptor that came along; others were not asked for and are closed.
void keep_attached(msghdr& message, FileDescriptor& attached) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t count = (part->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < count; ++i) {
      int fd = -1;
      std::memcpy(&fd, CMSG_DATA(part) + i * sizeof(int), sizeof fd);
      FileDescriptor received(fd);
      if (!attached) attached = std::move(received);
    }
  }
}

}  // namespace

// Returns the number of bytes read; zero if none are available now.
std::size_t Connection::read(std::byte* to, std::size_t size) {
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(int))> control{};
  iovec data{to, size};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  for (;;) {
    const ssize_t got = ::recvmsg(socket_.get(), &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
    if (got > 0) {
      keep_attached(message, message_.attached);
      last_progress_ = Clock::now();
      return std::size_t(got);
    }
    if (got == 0) throw ConnectionLost("closed the connection");
    if (errno == EAGAIN || errno == EWOULDBLOCK) return 0;
    if (errno != EINTR) throw ConnectionLost(fmt::format("lost the connection: {}", std::strerror(errno)));
  }
}

const MessageHeader* Connection::receive_header() {
  while (received_ < sizeof header_) {
    const std::size_t got =
        read(reinterpret_cast<std::byte*>(&header_) + received_, sizeof header_ - received_);
    if (got == 0) return nullptr;
    received_ += got;
    if (received_ == sizeof header_) check(header_, spoken_, max_payload_);
  }
  return &header_;
}

std::size_t Connection::receive_payload(std::span<std::byte> room) {
  const std::size_t left = sizeof header_ + std::size_t(header_.payload_bytes) - received_;
  const std::size_t got = read(room.data(), std::min(room.size(), left));
  received_ = got == left ? 0 : received_ + got;
  return got;
}

std::optional<Message> Connection::receive_some() {
  std::size_t taken = 0;
  while (taken < fair_share) {
    if (receive_header() == nullptr) return std::nullopt;
    const std::size_t have = received_ - sizeof header_;
    const std::size_t total = std::size_t(header_.payload_bytes);
    if (have < total) {
      // Memory grows with what has arrived, not with what was announced.
      if (message_.payload.size() == have)
        message_.payload.resize(std::min(total, std::max(limits::read_ahead, 2 * have)));
      const std::size_t got = read(message_.payload.data() + have, message_.payload.size() - have);
      if (got == 0) return std::nullopt;
      received_ += got;
      taken += got;
    }
    if (received_ - sizeof header_ == total) {
      received_ = 0;
      message_.type = header_.type;
      message_.sequence = header_.sequence;
      return std::exchange(message_, {});
    }
  }
  return std::nullopt;
}

Message Connection::receive(Deadline deadline) {
  for (;;) {
    if (std::optional<Message> message = receive_some()) return std::move(*message);
    if (Clock::now() >= deadline || !wait_until_ready(socket_.get(), POLLIN, deadline))
      throw ConnectionLost("did not answer in time");
  }
}

bool Connection::stalled(std::chrono::milliseconds patience) const {
  return unfinished() && Clock::now() - last_progress_ > patience;
}

void Connection::send(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts, Deadline deadline,
                      int attach) {
  write(type, sequence, parts, attach, [&] { return deadline; });
}

void Connection::send(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts,
                      std::chrono::milliseconds patience, int attach) {
  write(type, sequence, parts, attach, [&] { return Clock::now() + patience; });
}

/// `deadline_now` is called again whenever some bytes have been sent.
template <class DeadlineNow>
void Connection::write(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts, int attach,
                       DeadlineNow deadline_now) {
  MessageHeader header;
  header.type = type;
  header.sequence = sequence;
  for (const Bytes& part : parts) header.payload_bytes += part.size();

  std::vector<iovec> pieces{{&header, sizeof header}};
  // sendmsg() takes pointers to non-const, but does not write.
  for (const Bytes& part : parts)
    if (!part.empty()) pieces.push_back({const_cast<std::byte*>(part.data()), part.size()});

  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(int))> control{};
  msghdr message{};
  message.msg_iov = pieces.data();
  message.msg_iovlen = pieces.size();
  if (attach >= 0) {
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    cmsghdr* part = CMSG_FIRSTHDR(&message);
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = SCM_RIGHTS;
    part->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(part), &attach, sizeof attach);
  }

  Deadline deadline = deadline_now();
  while (message.msg_iovlen > 0) {
    const ssize_t sent = ::sendmsg(socket_.get(), &message, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0) {
      if (errno == EINTR) continue;
      if (errno != EAGAIN && errno != EWOULDBLOCK)
        throw ConnectionLost(errno == EPIPE ? "closed the connection"
                                            : fmt::format("lost the connection: {}", std::strerror(errno)));
      if (Clock::now() >= deadline || !wait_until_ready(socket_.get(), POLLOUT, deadline))
        throw ConnectionLost("does not read what it is sent");
      continue;
    }
    deadline = deadline_now();
    // The descriptor was sent with the first byte.
    message.msg_control = nullptr;
    message.msg_controllen = 0;
    for (std::size_t left = std::size_t(sent); message.msg_iovlen > 0;) {
      iovec& piece = *message.msg_iov;
      if (left < piece.iov_len) {
        piece.iov_base = static_cast<std::byte*>(piece.iov_base) + left;
        piece.iov_len -= left;
        break;
      }
      left -= piece.iov_len;
      ++message.msg_iov;
      --message.msg_iovlen;
    }
  }
}

}  // namespace understudy::compositor
