// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/slice_scene.h"

#include <utility>

namespace adversary {

const std::string slice_vertex_shader = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
out vec3 at;
void main() {
  at = position;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)";

std::string slice_fragment_shader(const std::string& declarations, const std::string& body) {
  return R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
in vec3 at;
out vec4 colour;
)" + declarations +
         R"(
void main() {
  float value = texture(volume, at).r;
  colour = texture(table, vec2(value, 0.5));
)" + body +
         "\n}\n";
}

SliceScene::SliceScene(Canvas& on, SliceSettings chosen)
    : canvas(on),
      settings(std::move(chosen)),
      program(on, settings.vertex, settings.fragment),
      vertices(on),
      volume(upload_volume(on, 0, settings.grid, settings.format)),
      table(upload_table_2d(on, 1, settings.table)) {
  program.use();
  program.set("volume", 0);
  program.set("table", 1);
}

Camera SliceScene::camera(int frame) const {
  return camera_at(settings.orbit, frame,
                   static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
}

std::vector<Polygon> SliceScene::polygons(const Camera& camera) const {
  const Order order = settings.blending == Blending::under ? Order::front_to_back : Order::back_to_front;
  return settings.across_axes ? axis_aligned_slices(camera, settings.slices, order)
                              : view_aligned_slices(camera, settings.slices, order);
}

void SliceScene::draw_slices(const Camera& camera) const {
  program.use();
  program.set("clip_from_object", camera.clip_from_object());
  set_blending(canvas.gl, settings.blending);
  vertices.draw(triangles(polygons(camera)));
}

void SliceScene::draw(int frame) const {
  const auto& [red, green, blue, alpha] = settings.background;
  canvas.begin(red, green, blue, alpha);
  draw_slices(camera(frame));
}

}  // namespace adversary
