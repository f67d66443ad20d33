// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/connector.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <stdexcept>

namespace understudy::compositor {

namespace {

constexpr std::size_t longest_path = sizeof sockaddr_un::sun_path;

/// The other process does not wait for a listener, so it answers soon, even if the caller's time is short.
constexpr std::chrono::seconds patience_with_answer{2};

struct Answer {
  std::uint64_t question = 0;
  std::int64_t error = 0;
};

struct Asking {
  std::mutex mutex;  // held from a question to its answer
  FileDescriptor channel;
  std::uint64_t questions = 0;
};

Asking& asking() {
  static Asking state;
  return state;
}

/// Space for one descriptor beside a message.
union DescriptorRoom {
  cmsghdr header;
  std::array<std::byte, CMSG_SPACE(sizeof(int))> bytes;
};

bool send_answer(int channel, std::uint64_t question, const ConnectionAttempt& attempt) {
  Answer answer{question, attempt.error};
  iovec part{&answer, sizeof answer};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  DescriptorRoom room{};
  if (attempt.socket) {
    message.msg_control = &room;
    message.msg_controllen = sizeof room;
    cmsghdr* const header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof(int));
    const int descriptor = attempt.socket.get();
    std::memcpy(CMSG_DATA(header), &descriptor, sizeof descriptor);
  }
  return ::sendmsg(channel, &message, MSG_NOSIGNAL | MSG_DONTWAIT) >= 0;
}

/// Returns null if the answer is to an earlier question, for which nobody waits any more.
std::optional<ConnectionAttempt> received_answer(int channel, std::uint64_t question) {
  ConnectionAttempt attempt;
  Answer answer;
  iovec part{&answer, sizeof answer};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  DescriptorRoom room{};
  message.msg_control = &room;
  message.msg_controllen = sizeof room;
  const ssize_t got = ::recvmsg(channel, &message, MSG_CMSG_CLOEXEC);
  if (got != ssize_t(sizeof answer)) return ConnectionAttempt{{}, ECONNRESET};
  attempt.error = int(answer.error);
  const cmsghdr* const header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_level == SOL_SOCKET && header->cmsg_type == SCM_RIGHTS) {
    int descriptor = -1;
    std::memcpy(&descriptor, CMSG_DATA(header), sizeof descriptor);
    attempt.socket = FileDescriptor(descriptor);
  }
  if (answer.question != question) return std::nullopt;
  if (attempt.error == 0 && !attempt.socket) attempt.error = ECONNRESET;
  return attempt;
}

/// The path may name no socket, and descriptors may be used up: neither ends the answering process.
ConnectionAttempt attempt_for_another(const std::string& path) {
  try {
    return attempt_to_connect(path);
  } catch (const std::runtime_error&) {
    return ConnectionAttempt{{}, EINVAL};
  }
}

}  // namespace

std::pair<FileDescriptor, FileDescriptor> connector_channel() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw std::runtime_error(fmt::format("cannot make a pair of sockets: {}", std::strerror(errno)));
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

void connect_through(FileDescriptor channel) {
  Asking& state = asking();
  const std::scoped_lock lock(state.mutex);
  state.channel = std::move(channel);
}

std::optional<ConnectionAttempt> ask_for_connection(const std::string& path, Deadline deadline) {
  Asking& state = asking();
  const std::scoped_lock lock(state.mutex);
  if (!state.channel) return std::nullopt;
  const int channel = state.channel.get();
  const std::uint64_t question = ++state.questions;
  std::array<iovec, 2> parts = {
      {{&state.questions, sizeof state.questions}, {const_cast<char*>(path.data()), path.size()}}};
  msghdr message{};
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  if (::sendmsg(channel, &message, MSG_NOSIGNAL) < 0) return ConnectionAttempt{{}, errno};
  const Deadline until = std::max(deadline, Clock::now() + patience_with_answer);
  while (wait_until_ready(channel, POLLIN, until)) {
    if (auto attempt = received_answer(channel, question)) return attempt;
  }
  return ConnectionAttempt{{}, ETIMEDOUT};
}

bool answer_connector(const FileDescriptor& channel, std::span<const std::string> allowed) {
  std::uint64_t question = 0;
  std::array<char, longest_path> text{};
  std::array<iovec, 2> parts = {{{&question, sizeof question}, {text.data(), text.size()}}};
  msghdr message{};
  message.msg_iov = parts.data();
  message.msg_iovlen = parts.size();
  // Attached descriptors are not received: there is no room for them.
  const ssize_t got = ::recvmsg(channel.get(), &message, MSG_DONTWAIT);
  if (got < 0) return errno == EAGAIN || errno == EINTR;
  if (got < ssize_t(sizeof question)) return false;
  const std::string path(text.data(), std::size_t(got) - sizeof question);
  const bool known =
      (message.msg_flags & MSG_TRUNC) == 0 && std::find(allowed.begin(), allowed.end(), path) != allowed.end();
  return send_answer(channel.get(), question,
                     known ? attempt_for_another(path) : ConnectionAttempt{{}, EACCES});
}

}  // namespace understudy::compositor
