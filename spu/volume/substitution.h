// What is found out about one run on its way to a picture.
#pragma once

#include <optional>
#include <string>

#include "spu/volume/volume_unit.h"

namespace understudy::spu {

/// Ends the substitution of one run: the application draws, and the reason goes to the report.
struct Doubt {
  std::string reason;
};

/// Nothing of the run is visible: the application may draw it, it costs nothing and means nothing.
struct NothingVisible {};

struct VolumeUnit::Substitution {
  const Run& run;
  const Pipeline& pipeline;
  KnownVolume& volume;
  std::uint64_t texture_version = 0;
  bool proxy = false;  ///< one draw of a box, whose fragment shader marches
  ObservedPolygons polygons{};
  std::optional<Capture> capture{};  ///< where a vertex shader was observed; its polygons are in `polygons`
  std::optional<CameraFit> fit{};
  FragmentInputs fragment{};
  SliceSet slices{};
  volume::RenderRequest request{};
};

}  // namespace understudy::spu
