// SPDX-License-Identifier: Apache-2.0
// OSMesa, Mesa's CPU renderer that needs neither EGL nor a kernel graphics driver: the only place that opens
// libOSMesa.
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

/// Members have the names of OSMesa's functions, without "OSMesa".
class Osmesa {
 public:
  /// Throws ContextUnavailable if libOSMesa is missing, or older than Mesa 12.
  Osmesa();

  /// Four bytes per pixel. Null if the driver has none of this kind.
  OSMesaContext create_context(const OsmesaContextWish& wish) const;

  decltype(&OSMesaCreateContextAttribs) CreateContextAttribs = nullptr;
  decltype(&OSMesaDestroyContext) DestroyContext = nullptr;
  decltype(&OSMesaMakeCurrent) MakeCurrent = nullptr;
  decltype(&OSMesaGetProcAddress) GetProcAddress = nullptr;
};

}  // namespace understudy::volume::offscreen
