// SPDX-License-Identifier: Apache-2.0
// Planes by which a ray caster cuts its volume: regions of a grid that it crops, and half-spaces.
//
// An image shows such planes only to within a step, so they are read from the uniforms whose names identify
// them (VTK's and ParaView's). The names are only a hypothesis: measurements are made with the planes lifted,
// and the image of the cut volume is compared with the application's own like any other.
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
  /// Convex parts of the volume whose samples are kept, nearest to the eye first. Samples stay where they are
  /// in the whole volume. One part without planes if nothing is cropped.
  std::vector<std::vector<volume::HalfSpace>> parts{{}};
  /// Planes at which rays begin and end, as at the faces of the box.
  std::vector<volume::HalfSpace> clipping;
};

/// Reads the cuts of `program`, as seen through a camera.
Cuts read_cuts(const GlContext& context, GLuint program, const volume::Matrix4& texture_to_clip);

/// The uniforms of a program that read_cuts reads at present: these may change, and what was measured with the
/// cuts lifted still holds. A uniform of such a name in another program is not among them.
class CutUniforms {
 public:
  CutUniforms(const GlContext& context, GLuint program);
  /// `uniform`: with an index.
  bool contains(std::string_view uniform) const;

 private:
  bool crops_;
  std::size_t clipping_numbers_ = 0;
};

/// While it lives, `program` draws its whole volume. The destructor restores the uniforms.
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

/// Returns boxes that make up the `kept` ones of the grid's 27 regions (x fastest), nearest to the eye first.
/// `planes` are the grid's, low and high of each axis. `eye` is homogeneous; with w = 0 it is the direction
/// towards the eye.
std::vector<std::vector<volume::HalfSpace>> kept_parts(const std::array<bool, 27>& kept,
                                                       const std::array<double, 6>& planes,
                                                       const std::array<double, 4>& eye);

}  // namespace understudy::spu
