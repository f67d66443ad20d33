// SPDX-License-Identifier: Apache-2.0
#include "volume/offscreen/osmesa.h"

#include <array>

namespace understudy::volume::offscreen {

Osmesa::Osmesa() {
  const SystemLibrary library({"libOSMesa.so.8", "libOSMesa.so.6"}, "libosmesa6");
  const auto find = [&](const char* name, auto& function) {
    library.find(name, "libosmesa6 of Mesa 12 or later", function);
  };
  find("OSMesaCreateContextAttribs", CreateContextAttribs);
  find("OSMesaDestroyContext", DestroyContext);
  find("OSMesaMakeCurrent", MakeCurrent);
  find("OSMesaGetProcAddress", GetProcAddress);
}

OSMesaContext Osmesa::create_context(const OsmesaContextWish& wish) const {
  const std::array<int, 17> attributes = {OSMESA_FORMAT,
                                          OSMESA_RGBA,
                                          OSMESA_DEPTH_BITS,
                                          wish.depth_bits,
                                          OSMESA_STENCIL_BITS,
                                          wish.stencil_bits,
                                          OSMESA_ACCUM_BITS,
                                          wish.accumulation_bits,
                                          OSMESA_PROFILE,
                                          wish.core ? OSMESA_CORE_PROFILE : OSMESA_COMPAT_PROFILE,
                                          OSMESA_CONTEXT_MAJOR_VERSION,
                                          wish.version / 100,
                                          OSMESA_CONTEXT_MINOR_VERSION,
                                          wish.version / 10 % 10,
                                          0};
  return CreateContextAttribs(attributes.data(), wish.share);
}

}  // namespace understudy::volume::offscreen
