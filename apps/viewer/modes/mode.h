// SPDX-License-Identifier: Apache-2.0
// A method to draw a volume's slices with OpenGL; one file per method.
//
//   rgba   colours looked up per voxel on the CPU, RGBA8 texture, fixed function, immediate mode
//   table  scalar texture, colours looked up per fragment in a 1-D texture (GLSL 1.20), vertex arrays
//   core   the same look-up in an OpenGL 3.3 core profile, all slices in one batch from a vertex buffer
//   time   like table, with a new time step in the texture every frame
//   bricks like table, with many small textures in visibility order
//   lit    like table, with directional light on the field's surfaces
//   preint pre-integrated segments: two samples and a 2-D look-up per fragment
//   stacks three stacks of 2-D textures instead of one 3-D texture
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apps/viewer/model/camera.h"
#include "apps/viewer/model/opaque_geometry.h"
#include "apps/viewer/model/slices.h"
#include "apps/viewer/model/texels.h"
#include "apps/viewer/model/transfer_function.h"

namespace viewer {

enum class ModeKind { rgba, table, core, time, bricks, lit, preint, stacks };

std::string_view name_of(ModeKind kind);
std::optional<ModeKind> mode_named(std::string_view name);

/// What changes between two frames of the time mode.
enum class TimeStep {
  whole,  ///< all texels change and are uploaded
  part,   ///< texels in the middle change, and only their box is uploaded
  again   ///< texels in the middle change, but all are uploaded
};

/// Owns its OpenGL objects: create, use and destroy it with the same context current.
class Mode {
 public:
  virtual ~Mode() = default;
  Mode() = default;
  Mode(const Mode&) = delete;
  Mode& operator=(const Mode&) = delete;

  /// Sets the colours of all slices drawn from now on.
  virtual void set_table(const Table& table) = 0;
  /// Called before anything of a frame is drawn.
  virtual void next_frame() {}
  virtual void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) = 0;
  /// The caller sets the blending and depth state.
  virtual void draw_slices(const SliceStack& stack, const Matrices& matrices) = 0;
  /// Name of the volume texture's internal format, such as "GL_R8".
  virtual std::string_view texture_format() const = 0;
};

/// Requires a current context: 3.3 core for core, compatibility for all others. `file` names the volume in
/// errors. Throws Error if the volume exceeds the texture limits, or OpenGL reports an error.
std::unique_ptr<Mode> make_mode(ModeKind kind, Texels texels, const std::string& file, TimeStep step);

}  // namespace viewer
