// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/sandbox/sandbox.h"

#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "apps/understudy/sandbox/file_restriction.h"
#include "compositor/service/client_limits.h"

namespace understudy::launcher {
namespace {

/// Connections, image buffers, and what a driver holds.
constexpr rlim_t most_descriptors = 256;

/// What drivers of graphics cards open when they draw. Homes and data are elsewhere.
constexpr auto read_by_cards =
    std::to_array<const char*>({"/dev", "/etc", "/lib", "/lib64", "/opt", "/proc", "/sys", "/usr"});

void bound(__rlimit_resource resource, rlim_t most) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) return;
  limit.rlim_max = std::min(limit.rlim_max, most);
  limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
  ::setrlimit(resource, &limit);
}

void bound_resources() {
  bound(RLIMIT_CORE, 0);
  bound(RLIMIT_NOFILE, most_descriptors);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  // Sanitizers reserve far more than there is.
  bound(RLIMIT_DATA, compositor::usable_memory());
#endif
}

}  // namespace

Sandbox::Sandbox(std::vector<std::filesystem::path> written) : written_(std::move(written)) {
  bound_resources();
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  if (restrict_writing(written_).empty()) landlock_ = landlock_version();
}

SandboxState Sandbox::close(Renderer renderer) const {
  const std::vector<std::filesystem::path> cards(read_by_cards.begin(), read_by_cards.end());
  const bool card = renderer == Renderer::graphics_card;
  SandboxState state;
  if (restrict_reading(card ? cards : std::vector<std::filesystem::path>()).empty()) state.landlock = landlock_;
  state.obstacle = restrict_system_calls(
      {.renderer = renderer, .opens_files = !written_.empty() || (card && state.landlock > 0)});
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
