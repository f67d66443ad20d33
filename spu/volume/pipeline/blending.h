// SPDX-License-Identifier: Apache-2.0
// How slices are put together in the framebuffer: which of the operators that the nodes know the application's
// blend equation and factors amount to, for colour and for alpha.
#pragma once

#include <optional>
#include <string>

#include "dispatch/table.h"
#include "spu/volume/pipeline/target.h"
#include "volume/blending_operator.h"
#include "volume/classification.h"

namespace understudy::spu {

/// What the slices leave in the framebuffer's alpha.
struct AlphaBlending {
  bool untouched = false;  ///< no alpha in the framebuffer, or masked, or factors ZERO, ONE
  volume::Operator op = volume::Operator::over;
  bool squared = false;  ///< the source factor is SRC_ALPHA: every fragment brings the square of its alpha

  bool operator==(const AlphaBlending&) const = default;
};

/// Where destination alpha says how much of a front-to-back drawing is still to be seen.
enum class FrontToBack {
  no,
  room,          ///< 1 - DST_ALPHA, ONE: alpha is what has been covered
  transparency,  ///< DST_ALPHA, ONE with ZERO, 1 - SRC_ALPHA: alpha is what has not
};

/// Why slices are not substituted where a fragment replaces what is there.
constexpr const char* slices_replace = "blending is disabled: what is drawn replaces what is there";

struct Blending {
  volume::Operator op = volume::Operator::over;
  FrontToBack front_to_back = FrontToBack::no;
  bool premultiplied = false;  ///< the fragment's colour is taken as it is, not times its alpha
  bool replaces = false;       ///< blending is disabled, or ONE, ZERO: a fragment replaces what is there
  AlphaBlending alpha;

  /// The image's own alpha is not what the slices leave: a second image is needed for it.
  bool alpha_stands_apart() const { return !alpha.untouched && (alpha.op != op || alpha.squared); }
  bool operator==(const Blending&) const = default;
};

/// Reads the blend state; a reason where no operator of the nodes' does the same.
std::optional<std::string> read_blending(const DispatchTable& gl, const Target& target, Blending& blending);

/// The classification whose image holds what `alpha` gathers in its first channel, and the fragments' alpha
/// in its last.
volume::Classification alpha_as_colour(const volume::Classification& classification,
                                       const AlphaBlending& alpha);

}  // namespace understudy::spu
