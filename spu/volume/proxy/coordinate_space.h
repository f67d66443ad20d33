// SPDX-License-Identifier: Apache-2.0
// Which input of the fragment stage addresses a ray caster's volume, and the box that is drawn in it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spu/volume/geometry/capture.h"
#include "spu/volume/pipeline/program_stages.h"
#include "spu/volume/program/ray_caster.h"
#include "spu/volume/proxy/ambiguous_steps.h"
#include "spu/volume/proxy/box.h"
#include "spu/volume/proxy/probe_surfaces.h"
#include "spu/volume/texture/texels.h"
#include "volume/image.h"

namespace understudy::spu {

/// Texture coordinate = scale * (input + origin) + offset, axis by axis.
struct CoordinateSpace {
  std::string input;
  /// Another input, or a uniform, that is constant over the draw. If `input` is the vector from the eye, as in
  /// shaders that interpolate the ray's direction, this is the eye's position. Empty: (0, 0, 0).
  std::string origin{};
  volume::Vec3 scale{1, 1, 1};
  volume::Vec3 offset{};
  bool of_whole_box = false;  ///< the box that was drawn is taken for the whole texture
  bool operator==(const CoordinateSpace&) const = default;
};

/// The box of one draw, in texture space.
struct ProxyBox {
  volume::Box region;
  CameraFit camera;
  std::vector<volume::HalfSpace> cuts;  ///< planes that cut off the corner in front of the near plane
};

/// What a measurement of `run` needs.
struct MarchContext {
  const GlContext& context;
  const Run& run;
  const ProgramStages& stages;
  const TextureDescription& texture;
  ProbeSurfaces& surfaces;
  std::array<float, 2> range;     ///< of the texels' values
  bool clipped = false;           ///< rays begin or end at clipping planes
  bool ends_at_geometry = false;  ///< rays end at opaque geometry, whose depth the program fetches
  /// Pixels of the window in which the program keeps fragments, if it discards others by position.
  std::optional<volume::Rect> kept{};
  /// As returned by neighbours_of_gradients() (program_check.h); not null: samples may be lit.
  std::optional<program::NeighbourDistance> neighbours{};
  /// Sampler names, as in program::RayFinding.
  std::span<const std::string> tables_of_one_texel{};
  std::span<const std::string> tables_of_gradients{};
  std::span<const MeasuredWay> ways{};  ///< of earlier views under the same steps
  const Capture* seen = nullptr;  ///< a capture of this run, used where it suffices instead of another draw
};

/// Whether the draw covers a whole box in some input of the fragment stage; `seen` is an existing capture of
/// it.
bool draws_box(const GlContext& context, const Run& run, const ProgramStages& stages, const Capture& seen);

/// Returns the coordinates that may address the volume, likelier ones first; those that differ by an offset
/// alone are adjacent. They are inputs of the fragment stage over which the draw is a whole box, or such inputs
/// plus the eye's position: as they are, in texels, or (inputs in world or object space) with the box as the
/// whole texture.
std::vector<CoordinateSpace> coordinate_spaces(const MarchContext& measured);

/// Returns the box of the draw in the texture space of `space`; null if it is not a closed surface (the near
/// plane has cut it).
std::optional<ProxyBox> proxy_box(const MarchContext& measured, const CoordinateSpace& space);

}  // namespace understudy::spu
