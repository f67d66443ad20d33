// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "volume/glsl/offscreen_context.h"
#include "volume/offscreen/egl.h"

namespace understudy::volume::glsl {

namespace {

using offscreen::Egl;

class EglContext final : public OffscreenContext {
 public:
  EglContext() {
    display_ = egl_.open_display(Egl::First::devices, "OpenGL 3.3 core context without a surface",
                                 [&](EGLDisplay display) { return make_context(display); });
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  ~EglContext() override { egl_.DestroyContext(display_, context_); }

  void make_current() override {
    // The bound API is per-thread state.
    if (!egl_.BindAPI(EGL_OPENGL_API) || !egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw std::runtime_error(fmt::format(
          "the GL backend's EGL context cannot be made current (EGL error {:#x}); --backend cpu does without",
          egl_.GetError()));
  }
  void release() noexcept override {
    egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  Function address(const char* name) const override { return egl_.GetProcAddress(name); }

 private:
  bool make_context(EGLDisplay display) {
    context_ = egl_.create_context(display, {.version = 330, .core = true});
    if (context_ == EGL_NO_CONTEXT) return false;
    if (egl_.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
      egl_.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      return true;
    }
    egl_.DestroyContext(display, context_);
    return false;
  }

  Egl egl_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<OffscreenContext> egl_context() {
  return std::make_unique<EglContext>();
}

}  // namespace understudy::volume::glsl
