// SPDX-License-Identifier: Apache-2.0
// The part of a viewport in which a program keeps its fragments.
//
// vispy clips every view to its place in the window with gl_FragCoord and `discard`, and at some sizes of the
// window this takes a row of pixels at its edge. Nothing that is measured on rays shows it; the images do.
#pragma once

#include <optional>

#include "spu/volume/verification/native_image.h"
#include "volume/image.h"

namespace understudy::spu {

struct KeptWindow {
  volume::Rect viewport;  ///< that it was found for; it says nothing about another
  volume::Rect kept;      ///< in pixels of the window

  bool operator==(const KeptWindow&) const = default;
};

/// The rectangle outside of which `native` shows nothing, where this alone is what `image` does differently:
/// the two are within the bound once `image` is cut to it, and `native` is cut off sharply at each edge that
/// cuts. Null: it is not.
std::optional<volume::Rect> kept_rect(const Pipeline& pipeline, const NativeImage& native,
                                      const volume::ImageView& image);

}  // namespace understudy::spu
