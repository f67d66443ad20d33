// SPDX-License-Identifier: Apache-2.0
// What a fragment stage that marches through a volume shows besides its samples.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spu/volume/program/influences.h"

namespace understudy::spu::program {

/// What a ray caster is allowed: colours from the volume's texels by way of tables, a loop that ends by where
/// the ray is, how long it is, and what it has gathered. All else is listed.
struct RayFinding {
  std::optional<std::size_t> loop;   ///< the outermost in which the volume is fetched; null: there is none
  std::vector<std::size_t> samples;  ///< fetches in the loop, one for every texel that differs in one iteration
  std::vector<std::size_t> outside;  ///< fetches of the volume outside it that reach anything
  std::vector<Influence> data;  ///< of colours and depth, other than texels and uniforms: position, time, ...
  std::vector<Influence> branches;     ///< what decides between colours, other than texels and uniforms
  std::vector<Influence> guards;       ///< texels that decide between colours, and numbers of iterations
  std::vector<Influence> discards;     ///< of discards, other than uniforms
  std::vector<Influence> loop_ends;    ///< of when loops end, other than uniforms
  std::vector<Influence> coordinates;  ///< of the volume's coordinate, other than uniforms
  std::vector<UniformUse> uniforms;
  std::vector<std::string> tables;  ///< samplers, other than the volume's, whose texels reach anything
  std::vector<std::string>
      tables_of_samples;  ///< of these, the ones that are addressed by texels of the volume alone
  std::vector<std::string>
      tables_of_one_texel;  ///< of these, the ones that no second texel reaches: no gradient
  std::vector<std::string>
      tables_of_gradients;  ///< of these, the ones that neighbours of a sample reach, and the sample does not
  bool discards_by_place = false;  ///< fragments, by gl_FragCoord.x or .y
  bool writes_depth = false;
  bool side_effects = false;

  /// Each iteration adds a function of one texel of the volume. What the caller has to measure, or to hold
  /// fixed, is in `guards`, `discards`, `loop_ends` and `coordinates`.
  bool of_one_texel_each() const {
    return loop && samples.size() == 1 && outside.empty() && data.empty() && branches.empty() && !side_effects;
  }

  std::vector<std::string> reasons;  ///< why of_one_texel_each() does not hold, one for each thing
};

/// Whether loop `inner` is run through in one iteration of `outer`: it is that loop, or stands in it.
bool is_within(const StageFacts& fragment, std::size_t inner, std::size_t outer);

/// What the distances between a point and the neighbours that its gradient is taken of are numbers of.
enum class NeighbourDistance : std::uint8_t {
  in_texture_space,  ///< constants and uniforms are added to the coordinate
  in_texels,         ///< of the texture that is bound: textureOffset, or the inverse of textureSize
};

/// Of fetches whose places differ by nothing but what is the same for the whole draw, as those of a gradient
/// do: the point, and neighbours at constant distances, one by one or in a loop over the axes. Null: they
/// differ by more.
std::optional<NeighbourDistance> neighbour_distance(const StageFacts& fragment,
                                                    std::span<const std::size_t> fetches);

/// Whether every table that more than one of these fetches could address, but for `others`, is addressed by one
/// of them alone.
bool address_tables_alone(const StageFacts& fragment, std::span<const std::size_t> fetches,
                          std::span<const std::string> others = {});

/// `volumes` names the samplers that are set to the volume's texture.
RayFinding ray_finding(const StageFacts& fragment, std::span<const std::string> volumes);

}  // namespace understudy::spu::program
