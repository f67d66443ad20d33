// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/offscreen.h"

#include <GL/glew.h>
// EGL is included after GLEW, which must come first.
#include <EGL/eglext.h>
#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <vector>

#include "apps/viewer/frames.h"
#include "apps/viewer/function_loading.h"
#include "apps/viewer/model/error.h"
#include "apps/viewer/scene.h"

namespace viewer {

namespace {

constexpr EGLint max_devices = 64;
constexpr EGLint max_configs = 256;

bool has_client_extension(std::string_view wanted) {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  return extensions &&
         (" " + std::string(extensions) + " ").find(fmt::format(" {} ", wanted)) != std::string::npos;
}

// Devices first, because they can be a real GPU. The surfaceless platform is Mesa's; the default display may
// require a display server.
std::vector<EGLDisplay> candidate_displays() {
  std::vector<EGLDisplay> displays;
  const auto query_devices =
      reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  const auto platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (platform_display && query_devices && has_client_extension("EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, max_devices> devices{};
    EGLint count = 0;
    if (query_devices(max_devices, devices.data(), &count))
      for (EGLint i = 0; i < count; ++i)
        displays.push_back(
            platform_display(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
  }
  if (platform_display && has_client_extension("EGL_MESA_platform_surfaceless"))
    displays.push_back(platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  displays.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
  std::erase(displays, EGL_NO_DISPLAY);
  return displays;
}

// eglChooseConfig sorts deeper colours first: 10 bits would precede the 8 bits of a window. No alpha unless it
// is needed, as in a window.
EGLConfig choose_config(EGLDisplay display, EGLint surface_type, EGLint alpha_bits) {
  const EGLint wanted[] = {EGL_SURFACE_TYPE,
                           surface_type,
                           EGL_RENDERABLE_TYPE,
                           EGL_OPENGL_BIT,
                           EGL_RED_SIZE,
                           8,
                           EGL_GREEN_SIZE,
                           8,
                           EGL_BLUE_SIZE,
                           8,
                           EGL_DEPTH_SIZE,
                           24,
                           EGL_ALPHA_SIZE,
                           alpha_bits,
                           EGL_NONE};
  std::array<EGLConfig, max_configs> configs{};
  EGLint count = 0;
  if (!eglChooseConfig(display, wanted, configs.data(), max_configs, &count)) return nullptr;
  for (EGLint i = 0; i < count; ++i) {
    EGLConfig config = configs[static_cast<std::size_t>(i)];
    EGLint red = 0, alpha = 0, samples = 0;
    eglGetConfigAttrib(display, config, EGL_RED_SIZE, &red);
    eglGetConfigAttrib(display, config, EGL_ALPHA_SIZE, &alpha);
    eglGetConfigAttrib(display, config, EGL_SAMPLES, &samples);
    if (red == 8 && alpha == alpha_bits && samples == 0) return config;
  }
  return nullptr;
}

EGLContext create_context(EGLDisplay display, EGLConfig config, ModeKind mode) {
  const EGLint core[] = {EGL_CONTEXT_MAJOR_VERSION,
                         3,
                         EGL_CONTEXT_MINOR_VERSION,
                         3,
                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                         EGL_NONE};
  const EGLint compatibility[] = {EGL_NONE};
  return eglCreateContext(display, config, EGL_NO_CONTEXT, mode == ModeKind::core ? core : compatibility);
}

}  // namespace

Offscreen::Offscreen(const Options& options, int width, int height) {
  eglBindAPI(EGL_OPENGL_API);
  const std::vector<EGLDisplay> displays = candidate_displays();
  // Prefer a pbuffer on any display to a framebuffer object: the end of its frames
  // (eglSwapBuffers) is visible to others.
  for (const OffscreenSurface kind : {OffscreenSurface::pbuffer, OffscreenSurface::framebuffer}) {
    if (options.surface != OffscreenSurface::any && options.surface != kind) continue;
    for (EGLDisplay display : displays) {
      if (!open(display, options, kind, width, height)) continue;
      load_opengl_functions();
      if (kind == OffscreenSurface::framebuffer) make_framebuffer(width, height);
      return;
    }
  }
  throw Error(ExitCode::no_opengl,
              fmt::format("no OpenGL{} context without a window: none of {} EGL displays provides one; install "
                          "libegl-mesa0 and check `eglinfo`, or draw in a window (without --offscreen)",
                          options.mode == ModeKind::core ? " 3.3 core" : "", displays.size()));
}

Offscreen::~Offscreen() {
  close();
}

bool Offscreen::open(EGLDisplay display, const Options& options, OffscreenSurface surface, int width,
                     int height) {
  if (!eglInitialize(display, nullptr, nullptr)) return false;
  display_ = display;
  const bool pbuffer = surface == OffscreenSurface::pbuffer;
  const EGLint alpha_bits = options.op == Operator::under ? 8 : 0;
  EGLConfig config = choose_config(display, pbuffer ? EGL_PBUFFER_BIT : EGL_DONT_CARE, alpha_bits);
  if (config) context_ = create_context(display, config, options.mode);
  if (context_ != EGL_NO_CONTEXT && pbuffer) {
    const EGLint size[] = {EGL_WIDTH, width, EGL_HEIGHT, height, EGL_NONE};
    surface_ = eglCreatePbufferSurface(display, config, size);
  }
  if (context_ != EGL_NO_CONTEXT && (!pbuffer || surface_ != EGL_NO_SURFACE) &&
      eglMakeCurrent(display, surface_, surface_, context_))
    return true;
  close();
  return false;
}

void Offscreen::close() {
  if (display_ == EGL_NO_DISPLAY) return;
  if (framebuffer_ != 0) {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(2, renderbuffers_.data());
  }
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  eglTerminate(display_);
  display_ = EGL_NO_DISPLAY;
  surface_ = EGL_NO_SURFACE;
  context_ = EGL_NO_CONTEXT;
}

void Offscreen::make_framebuffer(int width, int height) {
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glGenRenderbuffers(2, renderbuffers_.data());
  glBindRenderbuffer(GL_RENDERBUFFER, renderbuffers_[0]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, renderbuffers_[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, renderbuffers_[0]);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, renderbuffers_[1]);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(
        ExitCode::no_opengl,
        fmt::format("OpenGL provides no framebuffer object of {} x {} pixels; give a smaller --window-size",
                    width, height));
}

void Offscreen::present() {
  if (surface_ == EGL_NO_SURFACE) {
    glFinish();
    return;
  }
  if (!eglSwapBuffers(display_, surface_))
    throw Error(ExitCode::no_opengl,
                fmt::format("eglSwapBuffers failed with error 0x{:x}; try --offscreen-surface framebuffer",
                            eglGetError()));
}

void run_offscreen(const Options& options, Volume volume) {
  const auto [width, height] = options.window_size;
  Offscreen offscreen(options, width, height);
  Scene scene(options, std::move(volume));
  Frames frames(options, scene);
  while (!frames.finished()) frames.draw_next(options.camera, width, height, [&] { offscreen.present(); });
  frames.print_median();
}

}  // namespace viewer
