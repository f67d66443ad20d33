// SPDX-License-Identifier: Apache-2.0
// Classification by probing: the application's own fragment pipeline samples a texture with known texels and
// draws into a float framebuffer; the result is the transfer function. One mechanism for texture environments,
// look-up textures, window/level uniforms and colour maps in shader code: they are measured, not parsed.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "spu/volume/classification/fog.h"
#include "spu/volume/geometry/recognised_run.h"
#include "spu/volume/pipeline/pipeline.h"
#include "spu/volume/refusal/refusal.h"
#include "spu/volume/texture/texels.h"
#include "spu/volume/texture/value_range.h"
#include "volume/classification.h"

namespace understudy::spu {

struct GlContext;

/// The result of probing, valid for all runs whose inputs stay within `range`.
struct Probed {
  volume::Classification classification;
  std::optional<MeasuredFog> fog;
  InputRange range;
  std::optional<std::size_t>
      segment_end{};  ///< input that addresses the second sample of a pre-integrated segment
};

using ProbeFinding = std::variant<Probed, Refusal>;

/// `range` is the interval of texel values that the table covers. Uses the current context's fragment state
/// (texture environment, alpha test, uniforms) and leaves it unchanged.
ProbeFinding probe_classification(const GlContext& context, const Pipeline& pipeline,
                                  const TextureDescription& texture, const FragmentInputs& fragment,
                                  const std::array<float, 2>& range);

}  // namespace understudy::spu
