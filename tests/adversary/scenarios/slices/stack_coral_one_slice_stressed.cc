// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::slices {
namespace {

float coral(float x, float y, float z) {
  const float branches = std::sin(13 * x + 3 * z) * std::cos(12 * z - 2 * y) + std::sin(9 * y + 5 * x);
  return std::clamp(0.45F + 0.25F * branches + 0.2F * (shells(x, y, z) - 0.5F), 0.0F, 1.0F);
}

struct Aquarium {
  explicit Aquarium(Canvas& canvas)
      : program(canvas, R"(#version 400 core
in vec3 position;
uniform mat4 camera;
out vec3 tex;
void main() {
  tex = position;
  gl_Position = camera * vec4(position, 1.0);
}
)",
                R"(#version 400 core
uniform sampler3D coral;
uniform sampler1D tones;
uniform float thickness;
in vec3 tex;
out vec4 fragment;
void main() {
  vec4 tone = texture(tones, texture(coral, tex).r);
  fragment = vec4(tone.rgb, 1.0 - pow(1.0 - tone.a, thickness));
}
)"),
        vertices(canvas) {
    upload_volume(canvas, 0, sampled(44, coral));
    std::vector<Colour> tones = soft_colours();
    for (Colour& tone : tones) tone[3] = static_cast<std::uint8_t>(std::min(255, 3 * tone[3]));
    upload_table_1d(canvas, 1, tones);
  }
  GlslProgram program;
  VertexBuffer vertices;
};

}  // namespace

Scenario stack_coral_one_slice_stressed() {
  return {
      .sentence =
          "40 even slices along z, drawn one by one; from frame 10 on another one is four times as dense in "
          "each "
          "frame, by a uniform between draws; from frame 20 on slices lie closer near the eye, each with the "
          "uniform of its own thickness.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        return [&canvas, aquarium = std::make_shared<Aquarium>(canvas)](int frame) {
          const Gl& gl = canvas.gl;
          // The eye stays on the side of low z.
          const Camera camera =
              camera_at({.azimuth = -15, .elevation = 22, .distance = 2.4F, .degrees_each_frame = 1}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const bool towards_high = camera.forward.z > 0;
          canvas.begin(0.05F, 0.2F, 0.3F);
          gl.Enable(GL_BLEND);
          gl.BlendEquation(GL_FUNC_ADD);
          gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
          aquarium->program.use();
          aquarium->program.set("coral", 0);
          aquarium->program.set("tones", 1);
          aquarium->program.set("camera", camera.clip_from_object());
          constexpr int count = 40;
          const auto border = [&](int i) {  // 0 at the eye's side
            const float part = static_cast<float>(i) / count;
            return frame < 20 ? part : 0.5F * part + 0.5F * part * part;
          };
          for (int i = count - 1; i >= 0; --i) {
            const float near = border(i), far = border(i + 1);
            float thickness = count * (far - near);
            if (frame >= 10 && frame < 20 && i == frame - 8) thickness = 4;
            const float depth = 0.5F * (near + far);
            aquarium->program.set("thickness", thickness);
            aquarium->vertices.draw(
                triangles(std::vector<Polygon>{cut_box({0, 0, 1}, towards_high ? depth : 1 - depth)}));
          }
        };
      }};
}

}  // namespace adversary::slices
