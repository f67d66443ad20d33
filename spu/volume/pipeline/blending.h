// SPDX-License-Identifier: Apache-2.0
// How slices are blended in the framebuffer: maps the application's blend equation and factors to an operator
// of the nodes, for colour and for alpha.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dispatch/table.h"
#include "spu/volume/pipeline/target.h"
#include "volume/blending_operator.h"
#include "volume/classification.h"

namespace understudy::spu {

/// What the slices leave in the framebuffer's alpha.
struct AlphaBlending {
  bool untouched = false;  ///< no alpha in the framebuffer, or it is masked, or factors ZERO, ONE
  volume::Operator op = volume::Operator::over;
  bool squared = false;  ///< the source factor is SRC_ALPHA: every fragment contributes the square of its alpha

  bool operator==(const AlphaBlending&) const = default;
};

/// In front-to-back drawing, destination alpha determines how much of a fragment is visible.
enum class FrontToBack {
  no,
  room,          ///< 1 - DST_ALPHA, ONE: alpha is the accumulated opacity
  transparency,  ///< DST_ALPHA, ONE with ZERO, 1 - SRC_ALPHA: alpha is the remaining transparency
};

/// Why slices are not substituted if a fragment replaces the pixel.
constexpr const char* slices_replace = "blending is disabled: what is drawn replaces what is there";

struct Blending {
  volume::Operator op = volume::Operator::over;
  FrontToBack front_to_back = FrontToBack::no;
  bool premultiplied = false;  ///< the fragment's colour is used as it is, not multiplied by its alpha
  bool replaces = false;       ///< blending is disabled, or ONE, ZERO: a fragment replaces the pixel
  AlphaBlending alpha;

  /// The image's own alpha differs from what the slices leave: alpha requires a second image.
  bool alpha_stands_apart() const { return !alpha.untouched && (alpha.op != op || alpha.squared); }
  bool operator==(const Blending&) const = default;
};

/// Reads the blend state; returns a reason if no operator of the nodes is equivalent.
std::optional<std::string> read_blending(const DispatchTable& gl, const Target& target, Blending& blending);

/// Appends what a compatibility profile does to fragments before it blends them (clamping, alpha test), as
/// values to compare.
void append_fragment_operations(const DispatchTable& gl, std::vector<float>& values);

/// Returns the classification whose image has what `alpha` accumulates in its first channel, and the fragments'
/// alpha in its last.
volume::Classification alpha_as_colour(const volume::Classification& classification,
                                       const AlphaBlending& alpha);

}  // namespace understudy::spu
