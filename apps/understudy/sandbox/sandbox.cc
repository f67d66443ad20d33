// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/sandbox/sandbox.h"

#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "apps/understudy/sandbox/file_restriction.h"
#include "compositor/service/client_limits.h"

namespace understudy::launcher {
namespace {

/// For connections, image buffers, and the driver's descriptors.
constexpr rlim_t most_descriptors = 256;

/// Folders that drivers and their libraries open. Home folders and data are elsewhere.
constexpr auto of_systems = std::to_array<const char*>({"/etc", "/gnu/store", "/lib", "/lib64", "/nix/store",
                                                        "/opt", "/proc", "/run/opengl-driver", "/sys", "/usr"});

/// Not all of /dev: drivers need no terminal.
constexpr auto devices_of_drivers =
    std::to_array<const char*>({"/dev/dri", "/dev/dxg", "/dev/kfd", "/dev/null", "/dev/random", "/dev/udmabuf",
                                "/dev/urandom", "/dev/zero"});

std::vector<std::filesystem::path> devices() {
  std::vector<std::filesystem::path> found(devices_of_drivers.begin(), devices_of_drivers.end());
  std::error_code unreadable;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", unreadable))
    if (entry.path().filename().string().starts_with("nvidia")) found.push_back(entry.path());
  return found;
}

void bound(__rlimit_resource resource, rlim_t most) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) return;
  limit.rlim_max = std::min(limit.rlim_max, most);
  limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
  ::setrlimit(resource, &limit);
}

/// Makes the kernel end this process first when memory runs out, because no limit of a process counts
/// memory behind descriptors.
void be_ended_first() {
  std::ofstream("/proc/self/oom_score_adj") << 1000;
}

void bound_resources() {
  be_ended_first();
  bound(RLIMIT_CORE, 0);
  bound(RLIMIT_NOFILE, most_descriptors);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  // Sanitizers reserve far more address space than there is memory.
  bound(RLIMIT_DATA, compositor::usable_memory());
#endif
}

}  // namespace

Sandbox::Sandbox(const SandboxFolders& folders) : writes_(!folders.written.empty()) {
  bound_resources();
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  std::vector<std::filesystem::path> read(of_systems.begin(), of_systems.end());
  read.insert(read.end(), folders.libraries.begin(), folders.libraries.end());
  no_landlock_ = restrict_files({.read = read, .written = folders.written, .devices = devices()});
}

SandboxState Sandbox::close(Renderer renderer) const {
  SandboxState state;
  state.no_landlock = no_landlock_;
  if (no_landlock_.empty()) state.landlock = landlock_version();
  Opening opening = Opening::nothing;
  if (state.landlock > 0 && renderer == Renderer::graphics_card)
    opening = Opening::all;
  else if (state.landlock > 0 && writes_)
    opening = Opening::to_write;
  state.obstacle = restrict_system_calls({.renderer = renderer, .opening = opening});
  return state;
}

Renderer renderer_named(const std::string& name) {
  constexpr auto on_the_cpu =
      std::to_array<const char*>({"llvmpipe", "softpipe", "swrast", "Software Rasterizer", "SWR"});
  const bool cpu = std::any_of(on_the_cpu.begin(), on_the_cpu.end(),
                               [&](const char* known) { return name.find(known) != std::string::npos; });
  return cpu ? Renderer::cpu : Renderer::graphics_card;
}

}  // namespace understudy::launcher
