// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/session/own_nodes.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <thread>
#include <vector>

#include "compositor/logging/log.h"
#include "compositor/transport/runtime_folder.h"

namespace understudy::spu {
namespace {

constexpr std::chrono::seconds patience{5};

/// Returns build/bin/understudy, beside build/lib, which contains this library.
std::filesystem::path launcher_beside_this_library() {
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&start_own_nodes), &self) == 0 || self.dli_fname == nullptr)
    return {};
  std::error_code error;
  const std::filesystem::path library = std::filesystem::canonical(self.dli_fname, error);
  return library.parent_path().parent_path() / "bin" / "understudy";
}

/// Neither an entry library nor an option of the viewer may reach the nodes.
bool is_for_the_viewer_alone(std::string_view variable) {
  return variable.starts_with("LD_AUDIT=") || variable.starts_with("LD_PRELOAD=") ||
         variable.starts_with("UNDERSTUDY_");
}

/// Runs the command in the background of a shell that exits at once: the viewer must not find a child that it
/// did not start.
int spawn_apart(std::vector<std::string> words) {
  words.insert(words.begin(), {"/bin/sh", "-c", "\"$0\" \"$@\" &"});
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::vector<char*> environment;
  for (char** variable = environ; variable != nullptr && *variable != nullptr; ++variable) {
    if (!is_for_the_viewer_alone(*variable)) environment.push_back(*variable);
  }
  environment.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // A session of its own: Ctrl-C is for the viewer, and the nodes exit after it.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&attributes, &signals);
  sigfillset(&signals);
  posix_spawnattr_setsigdefault(&attributes, &signals);
  pid_t shell = -1;
  const int error =
      posix_spawn(&shell, arguments[0], &files, &attributes, arguments.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error == 0) {
    while (waitpid(shell, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  return error;
}

/// False if the service exited (it removes its folder) or was too slow.
bool socket_appears(const std::filesystem::path& socket) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < until && std::filesystem::exists(socket.parent_path())) {
    if (std::filesystem::exists(socket)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

}  // namespace

std::string start_own_nodes(int nodes) {
  std::string folder = compositor::runtime_folder() / "understudy-run-XXXXXX";
  if (mkdtemp(folder.data()) == nullptr) {
    logging::log(logging::Level::warn, "no render nodes: cannot make {}: {}", folder, std::strerror(errno));
    return {};
  }
  const std::filesystem::path launcher = launcher_beside_this_library();
  const int error = spawn_apart({launcher.string(), "serve", "-n", std::to_string(nodes), "--folder", folder,
                                 "--while", std::to_string(getpid())});
  const std::filesystem::path socket = std::filesystem::path(folder) / "nodes.sock";
  if (error == 0 && socket_appears(socket)) return socket;
  logging::log(logging::Level::warn, "no render nodes ({} does not serve); rendering inside the viewer instead",
               launcher.string());
  std::error_code already_gone;
  std::filesystem::remove_all(folder, already_gone);
  return {};
}

}  // namespace understudy::spu
