// SPDX-License-Identifier: Apache-2.0
#include "gl_application.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "spu/registry/assemble.h"
#include "spu/report/counters.h"
#include "spu/track/share_group.h"

#if defined(__SANITIZE_ADDRESS__)
/// What Mesa keeps until the process ends is not ours to free.
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

const DispatchTable& real_driver() {
  static const DispatchTable table = [] {
    DispatchTable filled{};
    for (std::size_t i = 0; i < call_count; ++i) {
      set_slot(filled, CallId(i), AnyFunction(eglGetProcAddress(call_name(CallId(i)))));
    }
    return filled;
  }();
  return table;
}

/// All volumes of this process so far; each application of the tests adds its own.
std::span<VolumeCounters> volumes() {
  return process_counters().volume;
}

}  // namespace

struct GlApplication::Egl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  EGLSurface surface = EGL_NO_SURFACE;

  ~Egl() {
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  }
};

std::unique_ptr<GlApplication> GlApplication::start(Profile profile, Options options) {
  // Whether the machine is fast enough is not what is tested.
  options.speed_guard = false;
  return start(profile, std::make_shared<RenderSession>(std::move(options)), nullptr);
}

std::unique_ptr<GlApplication> GlApplication::start_companion() const {
  return start(profile_, session_, this);
}

std::unique_ptr<GlApplication> GlApplication::start(Profile profile, std::shared_ptr<RenderSession> session,
                                                    const GlApplication* companion) {
  auto egl = std::make_unique<Egl>();
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
  egl->context = eglCreateContext(egl->display, config,
                                  companion != nullptr ? companion->egl_->context : EGL_NO_CONTEXT, attributes);
  const EGLint extent[] = {EGL_WIDTH, size, EGL_HEIGHT, size, EGL_NONE};
  egl->surface = eglCreatePbufferSurface(egl->display, config, extent);
  if (egl->context == EGL_NO_CONTEXT || egl->surface == EGL_NO_SURFACE ||
      !eglMakeCurrent(egl->display, egl->surface, egl->surface, egl->context)) {
    return nullptr;
  }
  std::unique_ptr<GlApplication> application(new GlApplication);
  application->egl_ = std::move(egl);
  application->profile_ = profile;
  application->session_ = std::move(session);
  application->group_ = companion != nullptr ? companion->group_ : std::make_shared<ShareGroup>();
  application->chain_ = std::make_unique<Chain>(real_driver(), application->group_, &install);
  if (assemble(*application->chain_, application->session_->options().chain, application->session_))
    return nullptr;
  application->chain_->make_current();
  application->substituted_before_ = application->substituted();
  application->left_before_ = application->left();
  application->sent_before_ = application->texel_bytes_sent();
  application->left_out_before_ = application->texel_bytes_left_out();
  return application;
}

GlApplication::~GlApplication() {
  if (chain_) chain_->settle();
  Chain::release_current();
}

const DispatchTable& GlApplication::gl() const {
  return installed != nullptr ? *installed : real_driver();
}
const DispatchTable& GlApplication::driver() const {
  return real_driver();
}

void GlApplication::use_chain(bool on) {
  if (on) {
    chain_->make_current();
  } else {
    chain_->settle();
    Chain::release_current();
  }
}

void GlApplication::end_frame() {
  if (Chain::current() == nullptr) return;
  chain_->settle();
  chain_->frame_ended(FrameEnd::swap);
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
  std::uint64_t sum = 0;
  for (const VolumeCounters& volume : volumes()) sum += volume.draws_substituted;
  return sum - substituted_before_;
}

std::uint64_t GlApplication::left() const {
  std::uint64_t sum = 0;
  for (const VolumeCounters& volume : volumes()) sum += volume.draws_left;
  return sum - left_before_;
}

std::uint64_t GlApplication::texel_bytes_sent() const {
  std::uint64_t sum = 0;
  for (const VolumeCounters& volume : volumes()) sum += volume.texel_bytes_sent;
  return sum - sent_before_;
}

std::uint64_t GlApplication::texel_bytes_left_out() const {
  std::uint64_t sum = 0;
  for (const VolumeCounters& volume : volumes()) sum += volume.texel_bytes_left_out;
  return sum - left_out_before_;
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
