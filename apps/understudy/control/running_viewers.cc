// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/control/running_viewers.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "apps/understudy/launch/say.h"
#include "compositor/transport/socket.h"
#include "spu/control/control_folder.h"

namespace understudy::launcher {
namespace {

namespace key = spu::control_key;
using compositor::Clock;
using compositor::Deadline;

/// A viewer answers on a thread of its own, whatever it draws.
constexpr std::chrono::seconds answer_patience{5};

void send_line(int socket, std::string_view line, Deadline deadline) {
  while (!line.empty()) {
    if (!compositor::wait_until_ready(socket, POLLOUT, deadline))
      throw std::runtime_error("it does not read requests");
    const ssize_t sent = ::send(socket, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) throw std::runtime_error(std::strerror(errno));
    if (sent > 0) line.remove_prefix(std::size_t(sent));
  }
}

/// Returns the line without its end.
std::string received_line(int socket, Deadline deadline) {
  std::string line;
  std::array<char, 65536> part;
  while (line.size() < spu::max_control_answer_bytes) {
    if (!compositor::wait_until_ready(socket, POLLIN, deadline)) throw std::runtime_error("it does not answer");
    const ssize_t got = ::recv(socket, part.data(), part.size(), MSG_DONTWAIT);
    if (got < 0 && errno != EAGAIN && errno != EINTR) throw std::runtime_error(std::strerror(errno));
    if (got == 0) throw std::runtime_error("it closed the connection without an answer");
    const std::string_view piece(part.data(), std::size_t(std::max<ssize_t>(got, 0)));
    const std::size_t end = piece.find('\n');
    line += piece.substr(0, end);
    if (end != std::string_view::npos) return line;
  }
  throw std::runtime_error("its answer is too long");
}

std::string names_of(std::span<const RunningViewer> viewers) {
  std::string names;
  for (const RunningViewer& viewer : viewers)
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", viewer.process, viewer.program());
  return names;
}

}  // namespace

std::string RunningViewer::program() const {
  const nlohmann::ordered_json::json_pointer place("/report/processes/0/program");
  const auto name = answer.contains(place) ? answer.at(place) : nlohmann::ordered_json();
  return name.is_string() ? std::filesystem::path(name.get<std::string>()).filename().string() : "?";
}

nlohmann::ordered_json ask(const std::filesystem::path& socket, const spu::ControlRequest& request) {
  const Deadline deadline = Clock::now() + answer_patience;
  const compositor::FileDescriptor connection = compositor::connect_to(socket, deadline);
  send_line(connection.get(), spu::line_of(request), deadline);
  auto answer = nlohmann::ordered_json::parse(received_line(connection.get(), deadline), nullptr, false);
  if (!answer.is_object() || !answer.contains(key::ok)) throw std::runtime_error("its answer is malformed");
  if (answer[key::ok] == true) return answer;
  const auto reason = answer.find(key::error);
  throw std::runtime_error(reason != answer.end() && reason->is_string() ? reason->get<std::string>()
                                                                         : "it refuses without a reason");
}

std::vector<RunningViewer> running_viewers() {
  const std::filesystem::path folder = spu::control_folder();
  spu::remove_dead_control_sockets(folder);
  std::vector<RunningViewer> viewers;
  for (const spu::ControlSocket& socket : spu::control_sockets(folder)) {
    try {
      viewers.push_back({socket.process, socket.path, ask(socket.path, {})});
    } catch (const std::exception& error) {
      say(fmt::format("process {} at '{}': {}", socket.process, socket.path.string(), error.what()));
    }
  }
  return viewers;
}

const RunningViewer& chosen_viewer(std::span<const RunningViewer> viewers, const std::string& name) {
  std::vector<const RunningViewer*> found;
  for (const RunningViewer& viewer : viewers) {
    if (name.empty() || name == std::to_string(viewer.process) || name == viewer.program())
      found.push_back(&viewer);
  }
  if (found.size() == 1) return *found.front();
  if (viewers.empty())
    throw std::runtime_error(
        "no viewer of yours runs under Understudy, or none has shown a frame yet; start one with: understudy "
        "run "
        "-- viewer args…");
  throw std::runtime_error(fmt::format("{}: {}; give the process id of one",
                                       found.empty()
                                           ? "'" + name + "' runs not under Understudy, these viewers do"
                                           : "several viewers run under Understudy",
                                       names_of(viewers)));
}

}  // namespace understudy::launcher
