// SPDX-License-Identifier: Apache-2.0
// Determines whether a fragment stage that slices a volume shows a function of the sample alone.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "spu/volume/program/influences.h"

namespace understudy::spu::program {

/// Uniforms are not among `others`: they are the same for all fragments of a draw, and must be kept fixed and
/// watched.
struct SliceFinding {
  /// Fetches of the volume that reach a colour, depth or discard, one for each texel that can differ.
  std::vector<std::size_t> texels;
  bool texels_vary_in_loop = false;  ///< one of them is fetched at another place in each iteration
  /// Each component of the first texel's coordinate is an unchanged component of a varying.
  bool coordinate_is_varying = false;
  /// Sources other than varyings and uniforms that reach a coordinate of the volume.
  std::vector<Influence> coordinate_others;
  std::vector<Influence> coordinate_varyings;  ///< varyings that reach a coordinate of the volume
  /// Sources other than the volume's texels and uniforms that reach colours, depth and discards.
  std::vector<Influence> others;
  std::vector<UniformUse> uniforms;
  bool side_effects = false;

  /// Returns whether colours, depth and discards are a function of one texel of the volume, as long as
  /// uniforms, and the textures named by `tables`, do not change.
  bool of_one_texel() const {
    return texels.size() == 1 && !texels_vary_in_loop && others.empty() && coordinate_others.empty() &&
           !side_effects;
  }

  std::vector<std::string> tables;  ///< samplers, other than the volume's, whose texels reach any target
  std::vector<std::string>
      reasons;  ///< why of_one_texel() is false, each reason once, the most important first
};

/// `volumes` names the samplers that are set to the volume's texture.
SliceFinding slice_finding(const StageFacts& fragment, std::span<const std::string> volumes);

}  // namespace understudy::spu::program
