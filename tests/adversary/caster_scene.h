// SPDX-License-Identifier: Apache-2.0
// A viewer that casts rays in GLSL 3.30, from the front faces of the volume's box. Volume on unit 0, table on
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

/// Gives `at`, where the ray enters.
extern const std::string caster_vertex_shader;

/// The parts of a marching fragment shader. Where they stand, `here` is the sample's place, `value` the sample,
/// `direction` the ray's direction of unit length, `step_length` a uniform, `count` how many samples the ray
/// has, `i` which this one is, and `shown` the output.
struct March {
  std::string declarations;
  std::string before;
  std::string each;
  std::string after;
};
std::string caster_fragment_shader(const March& march);

/// Composes front to back. `colour`, not premultiplied, is the sample's entry in the table before `body`
/// changes it.
std::string over_caster(const std::string& declarations = "", const std::string& body = "");

struct CasterSettings {
  std::string fragment = over_caster();
  std::string vertex = caster_vertex_shader;
  Grid grid = sampled(48, waves);
  VolumeFormat format = {};
  std::vector<Colour> table = soft_colours();
  Blending blending = Blending::premultiplied_over;
  float step_length = 0.025F;
  Orbit orbit = {};
  std::array<float, 4> background{0.1F, 0.12F, 0.2F, 1};
};

class CasterScene {
 public:
  CasterScene(Canvas& canvas, CasterSettings settings);

  /// Clears, takes the program into use, and draws. Uniforms are set before.
  void draw(int frame) const;
  /// Without clearing and without choosing a framebuffer.
  void draw_box(const Camera& camera) const;
  Camera camera(int frame) const;

  Canvas& canvas;
  CasterSettings settings;
  GlslProgram program;
  VertexBuffer vertices;
  GLuint volume;
  GLuint table;
};

inline std::shared_ptr<CasterScene> caster_scene(Canvas& canvas, CasterSettings settings = {}) {
  return std::make_shared<CasterScene>(canvas, std::move(settings));
}

}  // namespace adversary
