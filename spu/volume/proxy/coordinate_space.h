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
  /// Another input, or a uniform, whose value is one in all of the draw. Where `input` is the way from the eye,
  /// as in shaders that interpolate the ray's direction, this is the eye; empty: (0, 0, 0).
  std::string origin{};
  volume::Vec3 scale{1, 1, 1};
  volume::Vec3 offset{};
  bool of_whole_box = false;  ///< so that the box that was drawn is the whole texture
  bool operator==(const CoordinateSpace&) const = default;
};

/// The box of one draw, in texture space.
struct ProxyBox {
  volume::Box region;
  CameraFit camera;
  std::vector<volume::HalfSpace> cuts;  ///< where the application has cut it off before the near plane
};

/// Everything that `run` is measured on.
struct MarchContext {
  const GlContext& context;
  const Run& run;
  const ProgramStages& stages;
  const TextureDescription& texture;
  ProbeSurfaces& surfaces;
  std::array<float, 2> range;     ///< of the texels' values
  bool clipped = false;           ///< rays begin or end at clipping planes
  bool ends_at_geometry = false;  ///< at the opaque geometry, whose depth the program fetches
  /// Pixels of the window where the program keeps fragments, where it discards others by their place.
  std::optional<volume::Rect> kept{};
  /// As program_check.h has it; not null: samples may be lit.
  std::optional<program::NeighbourDistance> neighbours{};
  /// As of program::RayFinding: names of samplers.
  std::span<const std::string> tables_of_one_texel{};
  std::span<const std::string> tables_of_gradients{};
  std::span<const MeasuredWay> ways{};  ///< of earlier views under the same steps
  const Capture* seen = nullptr;  ///< of this run; where it tells what is asked, the run is not drawn once more
};

/// Whether the draw covers a whole box in some input of the fragment stage; `seen` is one that was captured
/// already.
bool draws_box(const GlContext& context, const Run& run, const ProgramStages& stages, const Capture& seen);

/// The coordinates that may address the volume: inputs of the fragment stage over which the draw is a whole
/// box, as they are, in texels, or with the box for the whole texture, which they are in the world or in the
/// object's own space, or such inputs plus the eye's position. The likelier ones first; those that differ by an
/// offset alone stand side by side.
std::vector<CoordinateSpace> coordinate_spaces(const MarchContext& measured);

/// The box of the draw in the texture space of `space`; null when it is no closed surface (the near plane has
/// cut it).
std::optional<ProxyBox> proxy_box(const MarchContext& measured, const CoordinateSpace& space);

}  // namespace understudy::spu
