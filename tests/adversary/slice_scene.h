// SPDX-License-Identifier: Apache-2.0
// A viewer that draws slices through a texture with GLSL 3.30 and vertex buffers. Volume on unit 0, table on
// unit 1.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary {

/// Gives `at`, the texture coordinate.
extern const std::string slice_vertex_shader;
/// `declarations` before main(); `body` after `value` is the sample and `colour`, the output, its entry in the
/// table.
std::string slice_fragment_shader(const std::string& declarations = "", const std::string& body = "");

struct SliceSettings {
  std::string fragment = slice_fragment_shader();
  std::string vertex = slice_vertex_shader;
  Grid grid = sampled(48, waves);
  VolumeFormat format = {};
  std::vector<Colour> table = soft_colours();
  Blending blending = Blending::over;
  int slices = 64;
  bool across_axes = false;
  Orbit orbit = {};
  std::array<float, 4> background{0.1F, 0.12F, 0.2F, 1};
};

class SliceScene {
 public:
  SliceScene(Canvas& canvas, SliceSettings settings);

  /// Clears, takes the program into use, and draws. Uniforms are set before.
  void draw(int frame) const;
  /// Without clearing and without choosing a framebuffer.
  void draw_slices(const Camera& camera) const;
  Camera camera(int frame) const;
  std::vector<Polygon> polygons(const Camera& camera) const;

  Canvas& canvas;
  SliceSettings settings;
  GlslProgram program;
  VertexBuffer vertices;
  GLuint volume;
  GLuint table;
};

inline std::shared_ptr<SliceScene> slice_scene(Canvas& canvas, SliceSettings settings = {}) {
  return std::make_shared<SliceScene>(canvas, std::move(settings));
}

}  // namespace adversary
