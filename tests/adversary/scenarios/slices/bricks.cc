// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <utility>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

namespace {

/// Where the planes of the whole volume cut its half from x = brick / 2 on, in coordinates of that half.
std::vector<Polygon> slices_of_half(const Camera& camera, int brick) {
  const Vector normal{0.5F * camera.forward.x, camera.forward.y, camera.forward.z};
  const float centre = 0.5F * (camera.forward.x + camera.forward.y + camera.forward.z);
  std::vector<Polygon> polygons;
  for (int i = 0; i < 64; ++i) {
    const float distance = centre + 1.732F * (0.5F - (static_cast<float>(i) + 0.5F) / 64);
    Polygon polygon = cut_box(normal, distance - 0.5F * camera.forward.x * static_cast<float>(brick));
    if (polygon.size() >= 3) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

}  // namespace

Scenario bricks() {
  return {.sentence =
              "The volume is cut across x into two textures that share a layer of texels, drawn in visibility "
              "order.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            constexpr int edge = 33, whole = 2 * edge - 1;
            const Grid grid = sampled(whole, edge, edge, waves);
            auto scene = slice_scene(canvas, {.vertex = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
uniform vec3 corner;
out vec3 at;
void main() {
  at = (0.5 + 32.0 * position) / 33.0;
  gl_Position = clip_from_object * vec4((corner + position) * vec3(0.5, 1.0, 1.0), 1.0);
}
)",
                                              .grid = part_of(grid, 0, 0, 0, edge, edge, edge)});
            const std::array<GLuint, 2> textures{
                scene->volume, upload_volume(canvas, 0, part_of(grid, edge - 1, 0, 0, edge, edge, edge))};
            return [&canvas, scene, textures](int frame) {
              const Camera camera = scene->camera(frame);
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->program.use();
              scene->program.set("clip_from_object", camera.clip_from_object());
              set_blending(canvas.gl, Blending::over);
              const bool second_is_nearer = camera.eye.x > 0.5F;
              for (const int brick : second_is_nearer ? std::array{0, 1} : std::array{1, 0}) {
                canvas.gl.ActiveTexture(GL_TEXTURE0);
                canvas.gl.BindTexture(GL_TEXTURE_3D, textures[static_cast<std::size_t>(brick)]);
                scene->program.set("corner", Vector{static_cast<float>(brick), 0, 0});
                scene->vertices.draw(triangles(slices_of_half(camera, brick)));
              }
            };
          }};
}

}  // namespace adversary::slices
