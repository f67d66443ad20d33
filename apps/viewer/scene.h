// SPDX-License-Identifier: Apache-2.0
// Draws the volume and everything around it to the current framebuffer of the current context.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "apps/viewer/modes/mode.h"
#include "apps/viewer/options.h"

namespace viewer {

/// Properties of the volume that are the same in all frames; kept after the texels are passed to OpenGL.
struct VolumeFacts {
  std::string file;
  VolumeSize size{};
  Vec3 spacing{};
  ScalarType type = ScalarType::u8;
  TexelFormat texel_format = TexelFormat::unorm8;
  double value_at_0 = 0;
  double value_at_1 = 0;
  std::int64_t not_finite = 0;
};

/// Position and colours of one drawn volume.
struct DrawnVolume {
  Vec3 scale;  ///< from texture to object space, before `translate`
  Vec3 translate;
  Table colours;  ///< as converted for the operator
};

/// Everything that determined one frame's image.
struct DrawnFrame {
  Camera camera;
  Matrices matrices;
  int width = 0;
  int height = 0;
  SliceStack stack;
  std::vector<DrawnVolume> volumes;  ///< in the order of drawing
};

class Scene {
 public:
  /// The mode's context must be current. Takes `volume` over. Prints one line about the volume, and warnings.
  Scene(const Options& options, Volume volume);

  /// Clears and draws; does not swap. Throws Error (no_opengl) if OpenGL reports an error.
  DrawnFrame draw(const Camera& camera, int width, int height);

  void set_preset(const Preset& preset);

  const VolumeFacts& volume() const { return volume_; }
  const Box& box() const { return box_; }
  const Preset& preset() const { return *preset_; }
  const Table& table() const { return table_; }
  const OpaqueGeometry& opaque() const { return opaque_; }
  /// Slice spacing over reference distance: the exponent of the opacity correction.
  double opacity_exponent() const;
  Operator op() const { return op_; }
  int slices_across_diagonal() const { return slices_across_diagonal_; }
  std::string_view texture_format() const { return mode_->texture_format(); }

 private:
  void draw_volumes(DrawnFrame& frame);
  void draw_back_to_front(DrawnFrame& frame);
  void draw_front_to_back(DrawnFrame& frame);

  VolumeFacts volume_;
  Box box_;
  int slices_across_diagonal_;
  Operator op_;
  std::array<double, 3> background_;
  bool write_depth_;
  OpaqueGeometry opaque_;
  std::unique_ptr<Mode> mode_;
  std::unique_ptr<Mode> second_;  ///< null: there is only one volume
  const Preset* preset_ = nullptr;
  Table table_{};
  Table second_table_{};
};

}  // namespace viewer
