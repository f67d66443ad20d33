// SPDX-License-Identifier: Apache-2.0
// Whether a fragment stage that slices a volume shows a function of the sample and of nothing else.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "spu/volume/program/influences.h"

namespace understudy::spu::program {

/// Uniforms are not among `others`: they are the same for all fragments of a draw, to be held fixed and
/// watched.
struct SliceFinding {
  /// Fetches of the volume that reach a colour, depth or discard, one for every texel that can differ.
  std::vector<std::size_t> texels;
  bool texels_vary_in_loop = false;  ///< one of them is fetched in several places, iteration by iteration
  /// Each component of the first texel's coordinate is a component of a varying, as it is.
  bool coordinate_is_varying = false;
  /// What besides varyings and uniforms reaches a coordinate of the volume.
  std::vector<Influence> coordinate_others;
  /// What besides the volume's texels and uniforms reaches colours, depth and discards.
  std::vector<Influence> others;
  std::vector<UniformUse> uniforms;
  bool side_effects = false;

  /// Colours, depth and discards are a function of one texel of the volume, as long as uniforms, and the
  /// textures that `tables` names, hold what they hold.
  bool of_one_texel() const {
    return texels.size() == 1 && !texels_vary_in_loop && others.empty() && coordinate_others.empty() &&
           !side_effects;
  }

  std::vector<std::string> tables;  ///< samplers, other than the volume's, whose texels reach anything
  std::vector<std::string>
      reasons;  ///< why of_one_texel() does not hold, one for each thing, the weightiest first
};

/// `volumes` names the samplers that are set to the volume's texture.
SliceFinding slice_finding(const StageFacts& fragment, std::span<const std::string> volumes);

}  // namespace understudy::spu::program
