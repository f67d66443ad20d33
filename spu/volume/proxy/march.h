// SPDX-License-Identifier: Apache-2.0
// How a fragment shader marches through its volume, measured on what it draws.
//
// Four things are determined: which input of the fragment stage is the texture coordinate, how samples are
// placed on a ray, how they are composed, and what colour one sample has. If several answers fit, all are
// returned: RayCasterStage takes the one whose image is closest to the application's.
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

/// Samples that are added up; opacity only shows whether there are any.
struct PlainSum {
  float alpha = 1;                                         ///< of every ray
  float ceiling = std::numeric_limits<float>::infinity();  ///< the largest sum that is shown
};

/// What a mean over a ray is taken of.
enum class Mean {
  of_colours,  ///< colours of the samples
  of_values    ///< values of the samples; the mean is classified
};

/// How tables of one colour replaced the program's own (plain_tables.h).
struct PlainTables {
  std::size_t of_opacity = 0;  ///< index of the table that holds the opacities
  float opacity = 0;           ///< in that table
  double of_sample = 0;        ///< resulting opacity of one sample
};

struct March {
  CoordinateSpace space;
  volume::RaySteps steps;
  /// Operator::max or Operator::min: samples are not composed; `table` classifies the largest (least) value of
  /// the ray.
  std::optional<volume::Operator> extreme;
  std::optional<Mean> mean;
  /// Whether a constant field has one colour, however long its rays are.
  bool shows_one_colour() const { return extreme || mean; }
  /// Whether fields have confirmed that samples lie on `steps`; for an extreme, the steps may only be likely.
  bool steps_seen = true;
  /// Metrics with the same counts of samples where they were counted, that of `steps` first
  /// (ambiguous_steps.h).
  std::vector<std::array<double, 9>> alike_metrics;
  std::optional<PlainSum> sum;
  /// For a sum or a mean: the alpha of rays so short that no sample lies on them; null: they show nothing.
  std::optional<float> shortest_alpha;
  /// Set if the program puts what it has composed by over onto a colour of its own: every fragment replaces
  /// what is there.
  std::optional<ShaderBackground> background;
  /// For samples that are composed by over: the program writes colours multiplied by alpha, and blending
  /// multiplies them by it once more.
  bool alpha_twice = false;
  /// For samples that are composed by over: as in RenderRequest (opacity_limit.h).
  float opacity_limit = 1;
  /// Likewise: the program shows rays that end at the limit as opaque.
  bool opaque_at_limit = false;
  std::optional<Jitter> jitter;  ///< where `steps.offsets` come from
  /// Premultiplied, of one sample. With light: in a constant field, or, if `light->even` is 0, on slopes that
  /// face the eye.
  volume::TransferFunction table;
  std::optional<volume::Light> light;
  /// Under which `light` was measured and is checked again; null: under the program's own.
  std::optional<PlainTables> plain_tables;
  std::size_t gradient_opacity_channel = 0;  ///< of the program's gradient table
  /// Under which the light's gradient opacity is checked again.
  std::optional<PlainTables> tables_under_gradients;
  /// Slopes by which `light` is measured and checked are at most this many times as steep as the gentlest
  /// measurable ones (SlopeProbe::over_steep).
  double slope_steepness = 16;
  /// Samples are rounded as some drivers do (classification/sample_rounding.h), which shows best in gradients
  /// of few texel values.
  bool rounds_samples = false;
  float translucent = 0;     ///< a value that about half of the light passes, on the longest ray that has one
  bool clipped = false;      ///< whether there were clipping planes
  bool from_exit = false;    ///< `steps` are counted from where rays leave the box (exit_steps.h)
  bool from_inside = false;  ///< whether the steps were measured with the eye inside
  double past_planes = 0;    ///< samples up to this many steps behind a plane by which a ray leaves still count
};

/// Marches that may be the application's, or the reason why there are none, as the report gives it.
using MarchFinding = std::variant<std::vector<March>, Refusal>;
MarchFinding measure_march(const MarchContext& measured, const std::vector<CoordinateSpace>& spaces);

/// Writes what the nodes are asked to render for a march.
void ask_nodes(const March& march, volume::RenderRequest& request);

/// Whether the nodes' image must be finished, and finishing it: extreme values get their colours, sums and
/// means become what is shown of them, rays that end at the limit become opaque, and colours are multiplied by
/// alpha where alpha is applied twice. A background is put behind later. Other samples that are composed by
/// over already are the image.
bool needs_finish(const March& march);
void finish_image(const March& march, volume::Image& image);

}  // namespace understudy::spu
