// SPDX-License-Identifier: Apache-2.0
// Planes by which a ray caster cuts its volume: regions of a grid that it crops away, and half-spaces.
//
// An image tells such planes only to within a step, so they are read from the uniforms whose names say what
// they hold (VTK's and ParaView's). The names only propose: measuring is done with the planes lifted, and the
// image of the cut volume is compared with the application's own like any other.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "dispatch/table.h"
#include "volume/texture_space.h"

namespace understudy::spu {

struct GlContext;

/// In texture space.
struct Cuts {
  /// Convex parts of the volume whose samples are kept, nearest to the eye first; the samples stay where they
  /// are in the whole volume. One part without planes where nothing is cropped.
  std::vector<std::vector<volume::HalfSpace>> parts{{}};
  /// Where rays begin and end, as at the faces of the box.
  std::vector<volume::HalfSpace> clipping;
};

/// The cuts of `program`, seen through a camera.
Cuts read_cuts(const GlContext& context, GLuint program, const volume::Matrix4& texture_to_clip);

/// Whether a uniform says where cuts are: they may change, and what was measured without them holds.
bool tells_cuts(std::string_view uniform);

/// While it lives, `program` draws its volume whole. Afterwards its uniforms are what they were.
class LiftedCuts {
 public:
  LiftedCuts(const GlContext& context, GLuint program);
  ~LiftedCuts();
  LiftedCuts(const LiftedCuts&) = delete;
  LiftedCuts& operator=(const LiftedCuts&) = delete;

 private:
  const DispatchTable& gl_;
  GLuint program_;
  std::vector<GLint> cropping_flags_;
  std::optional<GLfloat> clipping_numbers_;
};

/// The boxes of the grid of 27 regions (x fastest) that make up those that are `kept`, nearest to the eye
/// first. `planes` are the grid's, low and high of each axis; `eye` is homogeneous: with w = 0 it is the
/// direction towards the eye.
std::vector<std::vector<volume::HalfSpace>> kept_parts(const std::array<bool, 27>& kept,
                                                       const std::array<double, 6>& planes,
                                                       const std::array<double, 4>& eye);

}  // namespace understudy::spu
