// SPDX-License-Identifier: Apache-2.0
// OSMesa, Mesa's renderer on the CPU that needs neither EGL nor a kernel's graphics driver: the one place that
// opens libOSMesa.
#pragma once

#include <GL/osmesa.h>

#include "volume/offscreen/system_library.h"

namespace understudy::volume::offscreen {

struct OsmesaContextWish {
  int version = 210;  ///< 100 * major + 10 * minor
  bool core = false;
  int depth_bits = 0;
  int stencil_bits = 0;
  int accumulation_bits = 0;
  OSMesaContext share = nullptr;
};

/// OSMesa's functions are called by their own names, without "OSMesa".
class Osmesa {
 public:
  /// Throws ContextUnavailable where libOSMesa is missing, or older than Mesa 12.
  Osmesa();

  /// Four bytes a pixel. Null where the driver has none of this kind.
  OSMesaContext create_context(const OsmesaContextWish& wish) const;

  decltype(&OSMesaCreateContextAttribs) CreateContextAttribs = nullptr;
  decltype(&OSMesaDestroyContext) DestroyContext = nullptr;
  decltype(&OSMesaMakeCurrent) MakeCurrent = nullptr;
  decltype(&OSMesaGetProcAddress) GetProcAddress = nullptr;
};

}  // namespace understudy::volume::offscreen
