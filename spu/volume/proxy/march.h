// SPDX-License-Identifier: Apache-2.0
// How a fragment shader marches through its volume, measured on what it draws.
//
// Four things are asked: which input of the fragment stage is the texture coordinate, how samples are placed on
// a ray, how they are composed, and what colour one sample has. Where two answers fit, all are given: the
// volume unit takes the one whose image is the application's.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "spu/volume/proxy/background_removal.h"
#include "spu/volume/proxy/coordinate_space.h"
#include "spu/volume/proxy/jitter.h"
#include "spu/volume/refusal/refusal.h"
#include "volume/blending_operator.h"
#include "volume/classification.h"
#include "volume/image.h"
#include "volume/light.h"
#include "volume/sampling.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::spu {

/// Samples that are added up, where opacity says no more than that there are any.
struct PlainSum {
  float alpha = 1;                                         ///< of every ray
  float ceiling = std::numeric_limits<float>::infinity();  ///< the largest sum that is shown
};

/// Of what the mean over a ray is shown.
enum class Mean {
  of_colours,  ///< every sample has a colour
  of_values    ///< the mean has one
};

/// How tables of one colour were shown in place of the program's own (plain_tables.h).
struct PlainTables {
  std::size_t of_opacity = 0;  ///< which of the tables has the opacities
  float opacity = 0;           ///< in the table
  double of_sample = 0;        ///< what that makes of one sample
};

struct March {
  CoordinateSpace space;
  volume::RaySteps steps;
  /// Operator::max or Operator::min: samples are not composed, the largest (least) value of the ray is
  /// classified by `table`.
  std::optional<volume::Operator> extreme;
  std::optional<Mean> mean;
  /// Whether a field of one value has one colour, however long its rays are.
  bool shows_one_colour() const { return extreme || mean; }
  /// Whether fields have shown that samples lie on `steps`; those of an extreme may only be likely.
  bool steps_seen = true;
  /// Of steps that were counted: metrics that counted alike where they were, the one of `steps` first
  /// (ambiguous_steps.h).
  std::vector<std::array<double, 9>> alike_metrics;
  std::optional<PlainSum> sum;
  /// Of a sum or a mean: the alpha of rays so short that no sample lies on them; null: they show nothing.
  std::optional<float> shortest_alpha;
  /// The program puts what it has composed by over onto a colour of its own: every fragment replaces what is
  /// there.
  std::optional<ShaderBackground> background;
  /// Of samples that are composed by over: the program writes colours that are multiplied by alpha, and
  /// blending multiplies them by it once more.
  bool alpha_twice = false;
  /// Of samples that are composed by over: as of RenderRequest (opacity_limit.h).
  float opacity_limit = 1;
  /// Likewise: the program shows rays that end at the limit as opaque.
  bool opaque_at_limit = false;
  std::optional<Jitter> jitter;  ///< where `steps.offsets` come from
  /// Premultiplied; of one sample. Where there is light, in an even field, or, if `light->even` is 0, on slopes
  /// that face the eye.
  volume::TransferFunction table;
  std::optional<volume::Light> light;
  /// Under which `light` was measured and is looked at again; null: under the program's own.
  std::optional<PlainTables> plain_tables;
  std::size_t gradient_opacity_channel = 0;  ///< of the program's table of gradients
  /// Under which the light's gradient opacity is looked at again.
  std::optional<PlainTables> tables_under_gradients;
  /// Slopes by which `light` is measured and looked at again are at most so many times as steep as the gentlest
  /// that tell (SlopeProbe::over_steep).
  double slope_steepness = 16;
  /// Samples are rounded as some drivers do (classification/sample_rounding.h): gradients of few texel values
  /// are seen best.
  bool rounds_samples = false;
  float translucent = 0;     ///< a value whose field lets light through a ray, the longest that does
  bool clipped = false;      ///< whether there were clipping planes
  bool from_exit = false;    ///< `steps` are counted from where rays leave the box (exit_steps.h)
  bool from_inside = false;  ///< whether the steps were measured with the eye inside
  double past_planes = 0;    ///< samples up to so many steps behind one by which a ray leaves still count
};

/// Either marches that may be the application's, or why there are none, in words that end in the report.
using MarchFinding = std::variant<std::vector<March>, Refusal>;
MarchFinding measure_march(const MarchContext& measured, const std::vector<CoordinateSpace>& spaces);

/// What the nodes are asked to show for a march.
void ask_nodes(const March& march, volume::RenderRequest& request);

/// What their image then becomes: of extreme values the colours that these have, of sums what is shown of
/// them, and colours times alpha where alpha is applied twice. Other samples that are composed by over already
/// are the image.
bool needs_finish(const March& march);
void finish_image(const March& march, volume::Image& image);

}  // namespace understudy::spu
