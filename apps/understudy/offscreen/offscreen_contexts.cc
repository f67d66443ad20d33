// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/offscreen/offscreen_contexts.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "apps/understudy/offscreen/egl_contexts.h"
#include "apps/understudy/offscreen/osmesa_contexts.h"
#include "compositor/logging/log.h"

namespace understudy::launcher {
namespace {

/// Probed in this order.
constexpr std::array<int, 8> versions = {460, 450, 430, 330, 320, 310, 300, 210};

}  // namespace

bool is_core(const spu::RecordedContext& context) {
  return (context.profile & GL_CONTEXT_CORE_PROFILE_BIT) != 0;
}

void* OffscreenContexts::context_for(const spu::RecordedContext& wanted) const {
  if (void* made = make_context(wanted, wanted.version)) return made;
  for (const int version : versions) {
    if (version >= wanted.version && wanted.version != 0) continue;
    void* made = make_context(wanted, version);
    if (made == nullptr) continue;
    logging::log(logging::Level::warn, "the trace needs OpenGL {}.{}, but the OpenGL driver provides {}.{}",
                 wanted.version / 100, wanted.version / 10 % 10, version / 100, version / 10 % 10);
    return made;
  }
  throw std::runtime_error(fmt::format(
      "the OpenGL driver provides no OpenGL {}.{} {} context; another driver may: see `understudy doctor`",
      wanted.version / 100, wanted.version / 10 % 10, is_core(wanted) ? "core" : "compatibility"));
}

int OffscreenContexts::highest_version(bool core) const {
  spu::RecordedContext wanted;
  wanted.profile = core ? GL_CONTEXT_CORE_PROFILE_BIT : GL_CONTEXT_COMPATIBILITY_PROFILE_BIT;
  for (const int version : versions) {
    if (core && version < 320) break;
    void* context = make_context(wanted, version);
    if (context == nullptr) continue;
    end_context(context);
    return version;
  }
  return 0;
}

std::unique_ptr<OffscreenContexts> open_offscreen_contexts(std::string_view library) {
  if (library == "osmesa") return std::make_unique<OsmesaContexts>();
  std::string obstacle;
  try {
    auto contexts = std::make_unique<EglContexts>();
    if (library == "egl" || contexts->highest_version(false) + contexts->highest_version(true) > 0)
      return contexts;
    obstacle = "EGL's driver provides no OpenGL context; install libgl1-mesa-dri";
  } catch (const std::runtime_error& error) {
    if (library == "egl") throw;
    obstacle = error.what();
  }
  // Both libraries are Mesa's and share the current context; EGL has made none current here.
  std::unique_ptr<OffscreenContexts> contexts;
  try {
    contexts = std::make_unique<OsmesaContexts>();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}; OSMesa is not available either: {}", obstacle, error.what()));
  }
  logging::log(logging::Level::info, "drawing on OSMesa, because {}", obstacle);
  return contexts;
}

}  // namespace understudy::launcher
