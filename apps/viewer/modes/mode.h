// A way to draw a volume's slices with OpenGL; one file per way.
//
//   rgba   colours looked up per voxel on the CPU, RGBA8 texture, fixed function, immediate mode
//   table  scalar texture, colours looked up per fragment in a 1-D texture (GLSL 1.20), vertex arrays
//   core   the same look-up in an OpenGL 3.3 core profile, all slices in one batch from a vertex buffer
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apps/viewer/camera.h"
#include "apps/viewer/opaque_geometry.h"
#include "apps/viewer/slices.h"
#include "apps/viewer/texels.h"
#include "apps/viewer/transfer_function.h"

namespace viewer {

enum class ModeKind { rgba, table, core };

std::string_view name_of(ModeKind kind);
std::optional<ModeKind> mode_named(std::string_view name);

/// Owns its OpenGL objects: made, used and destroyed with the same context current.
class Mode {
 public:
  virtual ~Mode() = default;
  Mode() = default;
  Mode(const Mode&) = delete;
  Mode& operator=(const Mode&) = delete;

  /// The colours of all slices drawn from now on.
  virtual void set_table(const Table& table) = 0;
  virtual void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) = 0;
  /// Blending and depth state are the caller's.
  virtual void draw_slices(const SliceStack& stack, const Matrices& matrices) = 0;
  /// Name of the volume texture's internal format, such as "GL_R8".
  virtual std::string_view texture_format() const = 0;
};

/// Needs a current context: compatibility for rgba and table, 3.3 core for core. `file` names the volume in
/// errors. Throws Error when the volume does not fit the texture limits, or OpenGL refuses.
std::unique_ptr<Mode> make_mode(ModeKind kind, Texels texels, const std::string& file);

}  // namespace viewer
