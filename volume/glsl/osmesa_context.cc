// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "volume/glsl/offscreen_context.h"
#include "volume/offscreen/osmesa.h"

namespace understudy::volume::glsl {

namespace {

class OsMesaContext final : public OffscreenContext {
 public:
  OsMesaContext() : context_(osmesa_.create_context({.version = 330, .core = true})) {
    if (context_ == nullptr)
      throw ContextUnavailable(
          "libOSMesa gives no OpenGL 3.3 core context; install libosmesa6 of Mesa 12 or later");
  }
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;
  ~OsMesaContext() override { osmesa_.DestroyContext(context_); }

  void make_current() override {
    if (!osmesa_.MakeCurrent(context_, drawable_.data(), GL_UNSIGNED_BYTE, edge, edge))
      throw std::runtime_error(
          "the GL backend's OSMesa context cannot be made current; --backend cpu does without");
  }
  void release() noexcept override { osmesa_.MakeCurrent(nullptr, nullptr, 0, 0, 0); }
  Function address(const char* name) const override { return osmesa_.GetProcAddress(name); }

 private:
  static constexpr int edge = 4;

  offscreen::Osmesa osmesa_;
  OSMesaContext context_ = nullptr;
  std::array<unsigned char, 4 * edge * edge> drawable_{};  ///< never drawn to, but required by OSMesa
};

}  // namespace

std::unique_ptr<OffscreenContext> osmesa_context() {
  return std::make_unique<OsMesaContext>();
}

}  // namespace understudy::volume::glsl
