// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {
namespace {

constexpr const char* filter_fragment = R"(#version 330 core
uniform sampler3D scan;
uniform sampler2D colourMap;
uniform vec3 eye;
uniform float stride;
in vec3 at;
out vec4 pixel;

void main()
{
    vec3 way = at - eye;
    way /= length(way);
    vec3 bound = vec3(way.x > 0.0 ? 1.0 : 0.0, way.y > 0.0 ? 1.0 : 0.0, way.z > 0.0 ? 1.0 : 0.0);
    vec3 left = (bound - at) / way;
    float reach = min(left.x, min(left.y, left.z));
    vec3 rgb = vec3(0.0);
    float a = 0.0;
    for (int k = 0; k < 400; k++) {
        float gone = float(k) * stride;
        if (gone > reach)
            break;
        vec4 c = texture(colourMap, vec2(texture(scan, at + gone * way).r, 0.5));
        rgb += (1.0 - a) * c.a * c.rgb;
        a += (1.0 - a) * c.a;
    }
    pixel = vec4(rgb, a);
}
)";

}  // namespace

Scenario change_filter_and_viewport() {
  return {.sentence =
              "32 x 40 x 36 bytes, a thin 2-D table. The volume's filter is nearest in frames 7 to 13 and 21 "
              "to 24. "
              "In frames 10 to 16 the viewport is a part of the window, from frame 19 to 23 it is half as "
              "large again "
              "as the window and reaches out of it, then it is the whole window.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {7, 10, 14, 17, 19, 21, 24, 25},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, caster_vertex_shader, filter_fragment);
            const VertexBuffer vertices(canvas);
            const Field rocks = [](float x, float y, float z) {
              const float sum = std::sin(8 * x + 2 * y) + std::sin(10 * y - 4 * z + 1) +
                                std::cos(9 * z + 3 * x) + 0.6F * std::sin(15 * x * z + 4 * y);
              return std::clamp(0.48F + 0.17F * sum, 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float peak = std::exp(-std::pow((at - 0.65F) / 0.12F, 2.0F));
              table.push_back({static_cast<std::uint8_t>(250 * at), static_cast<std::uint8_t>(60 + 160 * peak),
                               static_cast<std::uint8_t>(255 - 200 * at),
                               static_cast<std::uint8_t>(std::lround(4 + 26 * peak))});
            }
            const GLuint volume = upload_volume(canvas, 0, sampled(32, 40, 36, rocks));
            upload_table_2d(canvas, 1, table);
            program.use();
            program.set("scan", 0);
            program.set("colourMap", 1);
            program.set("stride", 0.013F);
            return [&canvas, program, vertices, volume](int frame) {
              const Gl& gl = canvas.gl;
              if (frame == 7 || frame == 14 || frame == 21 || frame == 25) {
                const GLint filter = frame % 14 == 7 ? GL_NEAREST : GL_LINEAR;
                gl.ActiveTexture(GL_TEXTURE0);
                gl.BindTexture(GL_TEXTURE_3D, volume);
                gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
                gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, filter);
              }
              const int w = canvas.width(), h = canvas.height();
              canvas.begin(0.9F, 0.9F, 0.85F);
              float aspect = 1;
              if (frame >= 10 && frame <= 16) {
                gl.Viewport(w / 8, h / 4, 3 * w / 4, 5 * h / 8);
                aspect = 1.2F;
              } else if (frame >= 19 && frame <= 23) {
                gl.Viewport(-w / 4, -h / 8, 3 * w / 2, 3 * h / 2);
              }
              const Camera camera =
                  camera_at({.azimuth = 120, .elevation = 33, .degrees_each_frame = 2}, frame, aspect);
              program.use();
              program.set("clip_from_object", camera.clip_from_object());
              program.set("eye", camera.eye);
              set_blending(gl, Blending::premultiplied_over);
              gl.Enable(GL_CULL_FACE);
              gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
