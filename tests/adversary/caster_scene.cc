// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"

#include <utility>

namespace adversary {

const std::string caster_vertex_shader = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
out vec3 at;
void main() {
  at = position;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)";

std::string caster_fragment_shader(const March& march) {
  return R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;
)" + march.declarations +
         R"(
void main() {
  vec3 direction = normalize(at - eye);
  vec3 ends = (step(0.0, direction) - at) / direction;
  int count = int(min(ends.x, min(ends.y, ends.z)) / step_length) + 1;
)" + march.before +
         R"(
  for (int i = 0; i < count; ++i) {
    vec3 here = at + float(i) * step_length * direction;
    float value = texture(volume, here).r;
)" + march.each +
         R"(
  }
)" + march.after +
         "\n}\n";
}

std::string over_caster(const std::string& declarations, const std::string& body) {
  return caster_fragment_shader({.declarations = declarations,
                                 .before = "  vec4 sum = vec4(0.0);",
                                 .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n" + body +
                                         "\n    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                                 .after = "  shown = sum;"});
}

CasterScene::CasterScene(Canvas& on, CasterSettings chosen)
    : canvas(on),
      settings(std::move(chosen)),
      program(on, settings.vertex, settings.fragment),
      vertices(on),
      volume(upload_volume(on, 0, settings.grid, settings.format)),
      table(upload_table_2d(on, 1, settings.table)) {
  program.use();
  program.set("volume", 0);
  program.set("table", 1);
  program.set("step_length", settings.step_length);
}

Camera CasterScene::camera(int frame) const {
  return camera_at(settings.orbit, frame,
                   static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
}

void CasterScene::draw_box(const Camera& camera) const {
  program.use();
  program.set("clip_from_object", camera.clip_from_object());
  program.set("eye", camera.eye);
  set_blending(canvas.gl, settings.blending);
  canvas.gl.Enable(GL_CULL_FACE);
  canvas.gl.CullFace(GL_BACK);
  vertices.draw(box_triangles());
  canvas.gl.Disable(GL_CULL_FACE);
}

void CasterScene::draw(int frame) const {
  const auto& [red, green, blue, alpha] = settings.background;
  canvas.begin(red, green, blue, alpha);
  draw_box(camera(frame));
}

}  // namespace adversary
