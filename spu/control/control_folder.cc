// SPDX-License-Identifier: Apache-2.0
#include "spu/control/control_folder.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

#include "compositor/transport/runtime_folder.h"
#include "compositor/transport/socket.h"

namespace understudy::spu {
namespace {

constexpr const char* ending = ".sock";

std::optional<pid_t> process_of(const std::filesystem::path& socket) {
  if (socket.extension() != ending) return {};
  const std::string name = socket.stem();
  pid_t process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  if (error != std::errc{} || end != name.data() + name.size() || process <= 0) return {};
  return process;
}

}  // namespace

std::filesystem::path control_folder() {
  if (const auto own = compositor::private_runtime_folder()) return *own / "understudy";
  return fmt::format("/tmp/understudy-{}", ::geteuid());
}

void require_control_folder(const std::filesystem::path& folder) {
  struct stat about {};
  if (::lstat(folder.c_str(), &about) != 0)
    throw std::runtime_error(fmt::format("cannot look at '{}': {}", folder.string(), std::strerror(errno)));
  if (S_ISDIR(about.st_mode) && about.st_uid == ::geteuid() && (about.st_mode & 07777) == 0700) return;
  throw std::runtime_error(fmt::format(
      "'{}' is not a folder of yours with mode 0700, so viewers cannot be controlled there; remove it",
      folder.string()));
}

void make_control_folder(const std::filesystem::path& folder) {
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    throw std::runtime_error(fmt::format("cannot create '{}': {}", folder.string(), std::strerror(errno)));
  require_control_folder(folder);
}

std::filesystem::path control_socket(const std::filesystem::path& folder, pid_t process) {
  return folder / (std::to_string(process) + ending);
}

std::vector<ControlSocket> control_sockets(const std::filesystem::path& folder) {
  std::vector<ControlSocket> sockets;
  struct stat about {};
  if (::lstat(folder.c_str(), &about) != 0 && errno == ENOENT) return sockets;
  require_control_folder(folder);
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (const auto process = process_of(entry.path())) sockets.push_back({*process, entry.path()});
  }
  std::ranges::sort(sockets, {}, &ControlSocket::process);
  return sockets;
}

void remove_dead_control_sockets(const std::filesystem::path& folder) noexcept {
  try {
    for (const ControlSocket& socket : control_sockets(folder)) {
      // A socket gets its name when it already listens, so a refused connection means that its process is gone.
      if (compositor::attempt_to_connect(socket.path).error == ECONNREFUSED) ::unlink(socket.path.c_str());
    }
    ::rmdir(folder.c_str());
  } catch (const std::exception&) {
    // Left as it is.
  }
}

}  // namespace understudy::spu
