// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/offscreen/egl_contexts.h"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "dispatch/call_id.h"
#include "volume/offscreen/egl.h"

namespace understudy::launcher {
namespace {

using volume::offscreen::Egl;

/// EGL_PLATFORM=device probes devices before Mesa's surfaceless platform.
Egl::First first_platform() {
  const char* named = std::getenv("EGL_PLATFORM");
  return named != nullptr && std::string_view(named) == "device" ? Egl::First::devices
                                                                 : Egl::First::surfaceless;
}

}  // namespace

struct EglContexts::Library : Egl {
  EGLDisplay display = open_display(first_platform(), "desktop OpenGL", [](EGLDisplay) { return true; });

  EGLint attribute(EGLConfig config, EGLint name) const {
    EGLint value = 0;
    GetConfigAttrib(display, config, name, &value);
    return value;
  }

  /// Returns the closest configuration: missing bits weigh more than excess bits.
  EGLConfig config_for(const spu::RecordedContext& wanted) const {
    EGLint count = 0;
    GetConfigs(display, nullptr, 0, &count);
    std::vector<EGLConfig> configs(std::size_t(count), nullptr);
    GetConfigs(display, configs.data(), count, &count);
    const std::array<std::pair<EGLint, int>, 7> sizes = {{{EGL_RED_SIZE, wanted.red},
                                                          {EGL_GREEN_SIZE, wanted.green},
                                                          {EGL_BLUE_SIZE, wanted.blue},
                                                          {EGL_ALPHA_SIZE, wanted.alpha},
                                                          {EGL_DEPTH_SIZE, wanted.depth},
                                                          {EGL_STENCIL_SIZE, wanted.stencil},
                                                          {EGL_SAMPLES, wanted.samples}}};
    EGLConfig best = nullptr;
    int least = 0;
    for (EGLConfig config : configs) {
      if ((attribute(config, EGL_SURFACE_TYPE) & EGL_PBUFFER_BIT) == 0 ||
          (attribute(config, EGL_RENDERABLE_TYPE) & EGL_OPENGL_BIT) == 0) {
        continue;
      }
      int distance = 0;
      for (const auto& [name, size] : sizes) {
        const int more = attribute(config, name) - size;
        distance += more < 0 ? -100 * more : more;
      }
      if (best != nullptr && distance >= least) continue;
      best = config;
      least = distance;
    }
    return best;
  }

  EGLContext context_for(const spu::RecordedContext& wanted, int version, EGLConfig config,
                         EGLContext share) const {
    return create_context(display,
                          {.version = version, .core = is_core(wanted), .config = config, .share = share});
  }
};

struct EglContexts::Surface {
  EGLSurface surface = EGL_NO_SURFACE;
  spu::Extent2D extent;
};

struct EglContexts::Context {
  EGLConfig config = nullptr;
  EGLContext context = EGL_NO_CONTEXT;
  Surface own;
};

EglContexts::EglContexts() : egl_(std::make_unique<Library>()) {
  for (std::size_t i = 0; i < spu::call_count; ++i) {
    set_slot(driver_, spu::CallId(i), spu::AnyFunction(egl_->GetProcAddress(spu::call_name(spu::CallId(i)))));
  }
}

EglContexts::~EglContexts() {
  release_current();
  while (!contexts_.empty()) destroy(contexts_.begin()->first);
  for (const auto& [key, drawable] : surfaces_) egl_->DestroySurface(egl_->display, drawable.surface);
}

void* EglContexts::make_context(const spu::RecordedContext& wanted, int version) const {
  const auto share = contexts_.find(wanted.shares_with);
  return egl_->context_for(wanted, version, egl_->config_for(wanted),
                           share == contexts_.end() ? EGL_NO_CONTEXT : share->second.context);
}

void EglContexts::end_context(void* context) const {
  egl_->DestroyContext(egl_->display, context);
}

void EglContexts::create(const spu::RecordedContext& wanted) {
  contexts_[wanted.number] = {.config = egl_->config_for(wanted), .context = context_for(wanted), .own = {}};
}

/// Clears a new drawable, whose content is undefined, so that every replay is the same. Uses a temporary
/// context, so that the state of the recorded context is unchanged.
void EglContexts::clear(void* config, void* surface) {
  const EGLContext cleaner = egl_->CreateContext(egl_->display, config, EGL_NO_CONTEXT, nullptr);
  if (cleaner == EGL_NO_CONTEXT) return;
  if (egl_->MakeCurrent(egl_->display, surface, surface, cleaner))
    driver_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  release_current();
  egl_->DestroyContext(egl_->display, cleaner);
}

void EglContexts::make_current(std::uint64_t number, std::uint64_t drawable, spu::Extent2D extent) {
  Context& context = contexts_.at(number);
  Surface& place = drawable == 0 ? context.own : surfaces_[{context.config, drawable}];
  const EGLSurface old = place.surface;
  if (old == EGL_NO_SURFACE || place.extent != extent) {
    const EGLint sides[] = {EGL_WIDTH, extent.width, EGL_HEIGHT, extent.height, EGL_NONE};
    place.surface = egl_->CreatePbufferSurface(egl_->display, context.config, sides);
    place.extent = extent;
  }
  if (place.surface != old) clear(context.config, place.surface);
  if (place.surface == EGL_NO_SURFACE ||
      !egl_->MakeCurrent(egl_->display, place.surface, place.surface, context.context)) {
    throw std::runtime_error(fmt::format("EGL cannot make a drawable of {} x {} pixels current (error {:#x})",
                                         extent.width, extent.height, egl_->GetError()));
  }
  if (old != EGL_NO_SURFACE && old != place.surface) egl_->DestroySurface(egl_->display, old);
}

void EglContexts::release_current() {
  egl_->MakeCurrent(egl_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

void EglContexts::destroy(std::uint64_t number) {
  const auto found = contexts_.find(number);
  if (found == contexts_.end()) return;
  const EGLSurface own = found->second.own.surface;
  if (own != EGL_NO_SURFACE) egl_->DestroySurface(egl_->display, own);
  egl_->DestroyContext(egl_->display, found->second.context);
  contexts_.erase(found);
}

}  // namespace understudy::launcher
