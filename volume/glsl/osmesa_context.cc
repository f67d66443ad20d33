// SPDX-License-Identifier: Apache-2.0
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <array>

#include "volume/glsl/offscreen_context.h"

namespace understudy::volume::glsl {

namespace {

struct OsMesa {
  decltype(&OSMesaCreateContextAttribs) CreateContextAttribs = nullptr;
  decltype(&OSMesaDestroyContext) DestroyContext = nullptr;
  decltype(&OSMesaMakeCurrent) MakeCurrent = nullptr;
  decltype(&OSMesaGetProcAddress) GetProcAddress = nullptr;
};

template <class Pointer>
void find(void* library, const char* name, Pointer& pointer) {
  pointer = reinterpret_cast<Pointer>(dlsym(library, name));
  if (pointer == nullptr)
    throw ContextUnavailable(
        fmt::format("libOSMesa.so.8 has no {}: install libosmesa6 of Mesa 12 or later", name));
}

OsMesa open_osmesa() {
  void* library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw ContextUnavailable(fmt::format("{}: install libosmesa6", dlerror()));
  OsMesa osmesa;
  find(library, "OSMesaCreateContextAttribs", osmesa.CreateContextAttribs);
  find(library, "OSMesaDestroyContext", osmesa.DestroyContext);
  find(library, "OSMesaMakeCurrent", osmesa.MakeCurrent);
  find(library, "OSMesaGetProcAddress", osmesa.GetProcAddress);
  return osmesa;
}

class OsMesaContext final : public OffscreenContext {
 public:
  OsMesaContext() : osmesa_(open_osmesa()) {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    context_ = osmesa_.CreateContextAttribs(attributes, nullptr);
    if (context_ == nullptr)
      throw ContextUnavailable(
          "libOSMesa.so.8 gives no OpenGL 3.3 core context: install libosmesa6 of Mesa 12 or later");
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

  OsMesa osmesa_;
  OSMesaContext context_ = nullptr;
  std::array<unsigned char, 4 * edge * edge> drawable_{};  ///< never drawn to, but OSMesa wants one
};

}  // namespace

std::unique_ptr<OffscreenContext> osmesa_context() {
  return std::make_unique<OsMesaContext>();
}

}  // namespace understudy::volume::glsl
