// SPDX-License-Identifier: Apache-2.0
#include "gl_application.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "spu/chain.h"
#include "spu/options.h"
#include "spu/registry/assemble.h"
#include "spu/report/counters.h"
#include "spu/track/share_group.h"
#include "spu/volume/session/render_session.h"

#if defined(__SANITIZE_ADDRESS__)
/// Suppresses leak reports for memory that Mesa keeps until the process ends.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() {
  return "leak:_dri.so\nleak:libEGL_mesa\nleak:libLLVM\n";
}
#endif

namespace understudy::spu::testing {
namespace {

thread_local const DispatchTable* installed = nullptr;

void install(const DispatchTable* table) {
  installed = table;
}

std::uint64_t draws_made = 0;
decltype(DispatchTable::DrawArrays) driver_draw_arrays = nullptr;

void APIENTRY counted_draw_arrays(GLenum mode, GLint first, GLsizei count) {
  ++draws_made;
  driver_draw_arrays(mode, first, count);
}

const DispatchTable& real_driver() {
  static const DispatchTable table = [] {
    DispatchTable filled{};
    for (std::size_t i = 0; i < call_count; ++i) {
      set_slot(filled, CallId(i), AnyFunction(eglGetProcAddress(call_name(CallId(i)))));
    }
    driver_draw_arrays = filled.DrawArrays;
    filled.DrawArrays = counted_draw_arrays;
    return filled;
  }();
  return table;
}

/// All volumes of this process so far; each application of the tests adds its own.
std::span<VolumeCounters> volumes() {
  return process_counters().volume;
}

/// Sums over all volumes so far.
struct Sums {
  std::uint64_t substituted = 0;
  std::uint64_t left = 0;
  std::uint64_t texel_bytes_sent = 0;
  std::uint64_t texel_bytes_left_out = 0;
};

Sums sums() {
  Sums all;
  for (const VolumeCounters& volume : volumes()) {
    all.substituted += volume.draws_substituted;
    all.left += volume.draws_left;
    all.texel_bytes_sent += volume.texel_bytes_sent;
    all.texel_bytes_left_out += volume.texel_bytes_left_out;
  }
  return all;
}

/// A context of the driver with its own surface.
struct EglContext {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  EGLSurface surface = EGL_NO_SURFACE;

  EglContext() = default;
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  ~EglContext() {
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  }
};

/// Null if there is no such context, or it cannot be made current. Shares objects with `companion`.
std::unique_ptr<EglContext> make_current_context(Profile profile, EGLContext companion) {
  constexpr int size = GlApplication::size;
  auto egl = std::make_unique<EglContext>();
  egl->display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (!eglInitialize(egl->display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) return nullptr;
  const EGLint wanted[] = {EGL_SURFACE_TYPE,
                           EGL_PBUFFER_BIT,
                           EGL_RENDERABLE_TYPE,
                           EGL_OPENGL_BIT,
                           EGL_RED_SIZE,
                           8,
                           EGL_GREEN_SIZE,
                           8,
                           EGL_BLUE_SIZE,
                           8,
                           EGL_ALPHA_SIZE,
                           8,
                           EGL_DEPTH_SIZE,
                           24,
                           EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(egl->display, wanted, &config, 1, &count) || count == 0) return nullptr;
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               profile == Profile::core ? 3 : 4,
                               EGL_CONTEXT_MINOR_VERSION,
                               profile == Profile::core ? 3 : 5,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               profile == Profile::core ? EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT
                                                        : EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT,
                               EGL_NONE};
  egl->context = eglCreateContext(egl->display, config, companion, attributes);
  const EGLint extent[] = {EGL_WIDTH, size, EGL_HEIGHT, size, EGL_NONE};
  egl->surface = eglCreatePbufferSurface(egl->display, config, extent);
  if (egl->context == EGL_NO_CONTEXT || egl->surface == EGL_NO_SURFACE ||
      !eglMakeCurrent(egl->display, egl->surface, egl->surface, egl->context)) {
    return nullptr;
  }
  return egl;
}

}  // namespace

struct GlApplication::Parts {
  std::unique_ptr<EglContext> egl;
  Profile profile = Profile::compatibility;
  std::shared_ptr<RenderSession> session;
  std::shared_ptr<ShareGroup> group;
  std::unique_ptr<Chain> chain;
  Sums before;
};

std::unique_ptr<GlApplication> GlApplication::start(Profile profile) {
  return start(profile, Options{});
}

std::unique_ptr<GlApplication> GlApplication::start(Profile profile, const Options& options) {
  Options without_guard = options;
  // These tests do not measure speed.
  without_guard.speed_guard = false;
  return start(profile, std::make_shared<RenderSession>(std::move(without_guard)), nullptr);
}

std::unique_ptr<GlApplication> GlApplication::start_companion() const {
  return start(parts_->profile, parts_->session, this);
}

std::unique_ptr<GlApplication> GlApplication::start(Profile profile, std::shared_ptr<RenderSession> session,
                                                    const GlApplication* companion) {
  auto parts = std::make_unique<Parts>();
  parts->egl =
      make_current_context(profile, companion != nullptr ? companion->parts_->egl->context : EGL_NO_CONTEXT);
  if (parts->egl == nullptr) return nullptr;
  parts->profile = profile;
  parts->session = std::move(session);
  parts->group = companion != nullptr ? companion->parts_->group : std::make_shared<ShareGroup>();
  parts->chain = std::make_unique<Chain>(real_driver(), parts->group, &install);
  if (assemble(*parts->chain, parts->session->options().chain, parts->session)) return nullptr;
  parts->chain->make_current();
  parts->before = sums();
  return std::unique_ptr<GlApplication>(new GlApplication(std::move(parts)));
}

GlApplication::GlApplication(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

GlApplication::~GlApplication() {
  parts_->chain->settle();
  Chain::release_current();
}

std::uint64_t GlApplication::draws_of_arrays() {
  return draws_made;
}

RenderSession& GlApplication::session() const {
  return *parts_->session;
}

const DispatchTable& GlApplication::gl() const {
  return installed != nullptr ? *installed : real_driver();
}
const DispatchTable& GlApplication::driver() const {
  return real_driver();
}

void GlApplication::use_chain(bool on) {
  if (on) {
    parts_->chain->make_current();
  } else {
    parts_->chain->settle();
    Chain::release_current();
  }
}

void GlApplication::end_frame() {
  if (Chain::current() == nullptr) return;
  parts_->chain->settle();
  parts_->chain->frame_ended(FrameEnd::swap);
}

std::vector<float> GlApplication::read_pixels() {
  std::vector<float> pixels(std::size_t(4) * size * size);
  gl().ReadPixels(0, 0, size, size, GL_RGBA, GL_FLOAT, pixels.data());
  return pixels;
}

std::vector<float> GlApplication::read_depth() {
  std::vector<float> pixels(std::size_t(size) * size);
  gl().ReadPixels(0, 0, size, size, GL_DEPTH_COMPONENT, GL_FLOAT, pixels.data());
  return pixels;
}

std::uint64_t GlApplication::substituted() const {
  return sums().substituted - parts_->before.substituted;
}

std::uint64_t GlApplication::left() const {
  return sums().left - parts_->before.left;
}

std::uint64_t GlApplication::texel_bytes_sent() const {
  return sums().texel_bytes_sent - parts_->before.texel_bytes_sent;
}

std::uint64_t GlApplication::texel_bytes_left_out() const {
  return sums().texel_bytes_left_out - parts_->before.texel_bytes_left_out;
}

std::string GlApplication::last_reason() const {
  std::string reason;
  for (const ReasonCount& slot : last_volume().left_because) {
    if (slot.reason[0] != 0) reason = slot.reason;
  }
  return reason;
}

const VolumeCounters& GlApplication::last_volume() {
  return *std::max_element(
      volumes().begin(), volumes().end(),
      [](const VolumeCounters& a, const VolumeCounters& b) { return a.number < b.number; });
}

std::vector<std::uint8_t> Blob::texels() const {
  std::vector<std::uint8_t> field;
  for (int k = 0; k < z; ++k) {
    for (int j = 0; j < y; ++j) {
      for (int i = 0; i < x; ++i) {
        const double u = (i + 0.5) / x - 0.5;
        const double v = (j + 0.5) / y - 0.45;
        const double w = (k + 0.5) / z - 0.55;
        const double r = std::sqrt(u * u + v * v + w * w);
        field.push_back(
            std::uint8_t(255 * std::exp(-30 * (r - 0.25) * (r - 0.25)) * (0.6 + 0.4 * std::sin(9 * u))));
      }
    }
  }
  return field;
}

double psnr(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return -10 * std::log10(sum / double(a.size()));
}

}  // namespace understudy::spu::testing
