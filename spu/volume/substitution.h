// What is found out about one run on its way to an image.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spu/volume/geometry/slice_segment.h"
#include "spu/volume/recognition/program_check.h"
#include "spu/volume/verification/native_image.h"
#include "spu/volume/volume_unit.h"
#include "volume/request.h"

namespace understudy::spu {

/// Ends the substitution of one run: the application draws, and the reason goes to the report.
struct Refusal {
  std::string reason;
};

/// Nothing of the run is visible: the application may draw it, it costs nothing and means nothing.
struct NothingVisible {};

/// The order in which slices must be drawn for the nodes' operator to do the same.
SliceOrder order_of(const Pipeline& pipeline);

/// After this many refusals in a row a ray caster is measured only in one frame of so many.
constexpr int patient_refusals = 8;
constexpr std::uint64_t refused_retry_frames = 64;

struct VolumeUnit::Substitution {
  const Run& run;
  const Pipeline& pipeline;
  KnownVolume& volume;
  std::uint64_t texture_version = 0;
  bool proxy = false;  ///< one draw of a box, whose fragment shader marches
  ObservedPolygons polygons{};
  std::vector<float> fog_numbers{};  ///< of fixed-function fog, vertex by vertex
  std::optional<Capture>
      capture{};  ///< where a vertex shader was observed; polygons of slices are in `polygons`
  std::optional<CameraFit> fit{};
  FragmentInputs fragment{};
  std::vector<GLuint> stack{};  ///< the textures of a stack, from the volume's low end to its high end
  SliceSet slices{};
  Cuts cuts{};                                ///< of a ray caster
  bool eye_inside = false;                    ///< of a ray caster's box
  std::vector<volume::HalfSpace> ray_ends{};  ///< planes where its rays begin and end
  /// Of the application's opaque geometry, where the request's own depth tells ends of rays as well.
  std::optional<volume::DepthImage> opaque{};
  std::vector<ObservedSegment> slice_segments{};  ///< what may be the second coordinates of segments
  volume::RenderRequest request{};
  VerificationSchedule::Inputs inputs{};  ///< what its image depends on
  std::optional<NativeImage> drawn{};     ///< the application's own, where that was drawn already
};

}  // namespace understudy::spu
