// SPDX-License-Identifier: Apache-2.0
// Determines what a fragment stage that marches through a volume shows besides its samples.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spu/volume/program/influences.h"

namespace understudy::spu::program {

/// A ray caster may take colours from the volume's texels through tables, in a loop that ends depending on the
/// ray's position, its length, and what it has accumulated. Everything else is listed.
struct RayFinding {
  std::optional<std::size_t> loop;   ///< the outermost in which the volume is fetched; null: none
  std::vector<std::size_t> samples;  ///< fetches in the loop, one for each texel that differs in one iteration
  std::vector<std::size_t> outside;  ///< fetches of the volume outside of the loop that reach any target
  std::vector<Influence> data;  ///< on colours and depth, except of texels and uniforms: position, time, ...
  std::vector<Influence> branches;     ///< deciding between colours, except of texels, iterations, uniforms
  std::vector<Influence> guards;       ///< texels and iterations that decide between colours
  std::vector<Influence> discards;     ///< on discards, except of uniforms
  std::vector<Influence> loop_ends;    ///< on when loops end, except of uniforms
  std::vector<Influence> coordinates;  ///< on the volume's coordinate, except of uniforms
  std::vector<UniformUse> uniforms;
  std::vector<std::string> tables;  ///< samplers, other than the volume's, whose texels reach any target
  std::vector<std::string>
      tables_of_samples;  ///< those of `tables` that are addressed by texels of the volume alone
  std::vector<std::string>
      tables_of_one_texel;  ///< those of tables_of_samples that no second texel reaches: no gradient
  std::vector<std::string>
      tables_of_gradients;         ///< those of tables_of_samples that only neighbours of a sample reach
  bool discards_by_place = false;  ///< fragments are discarded by gl_FragCoord.x or .y
  bool writes_depth = false;
  bool side_effects = false;

  /// Returns whether each iteration adds a function of one texel of the volume. What the caller must measure,
  /// or keep fixed, is in `guards`, `discards`, `loop_ends` and `coordinates`.
  bool of_one_texel_each() const {
    return loop && samples.size() == 1 && outside.empty() && data.empty() && branches.empty() && !side_effects;
  }

  std::vector<std::string> reasons;  ///< why of_one_texel_each() is false, each reason once
};

/// Returns whether loop `inner` runs within one iteration of `outer`: it is that loop, or is nested in it.
bool is_within(const StageFacts& fragment, std::size_t inner, std::size_t outer);

/// Unit of the distances between a point and the neighbours from which its gradient is computed.
enum class NeighbourDistance : std::uint8_t {
  in_texture_space,  ///< constants and uniforms are added to the coordinate
  in_texels,         ///< of the bound texture: textureOffset, or the inverse of textureSize
};

/// Returns the unit for fetches whose places differ only by what is the same for the whole draw, as those of a
/// gradient do: the point, and neighbours at constant distances, one by one or in a loop over the axes. Null if
/// they differ by more.
std::optional<NeighbourDistance> neighbour_distance(const StageFacts& fragment,
                                                    std::span<const std::size_t> fetches);

/// Returns whether every table, except `others`, that several of these fetches could address is addressed by
/// one of them only.
bool address_tables_alone(const StageFacts& fragment, std::span<const std::size_t> fetches,
                          std::span<const std::string> others = {});

/// `volumes` names the samplers that are set to the volume's texture.
RayFinding ray_finding(const StageFacts& fragment, std::span<const std::string> volumes);

}  // namespace understudy::spu::program
