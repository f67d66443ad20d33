// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario shaded_fades_with_slope() {
  return {.sentence =
              "Lambert's light from the eye on both sides, 64 x 48 x 64 floats, GLSL 4.10; where the gradient "
              "is small the light fades into the unlit colour, so that noise is not shaded.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 410 core
layout(location = 0) in vec3 i_corner;
uniform mat4 u_clipFromWorld;
uniform vec3 u_eye;
out vec3 f_entry;
out vec3 f_dir;
void main()
{
    f_entry = i_corner;
    f_dir = i_corner - u_eye;
    gl_Position = u_clipFromWorld * vec4(i_corner, 1.0);
}
)",
                                      R"(#version 410 core
in vec3 f_entry;
in vec3 f_dir;
out vec4 o_colour;
uniform sampler3D u_field;
uniform sampler2D u_map;
uniform float u_ds;
uniform vec3 u_texel;
uniform vec2 u_slopes;

vec3 nabla(vec3 x)
{
    vec3 r;
    for (int i = 0; i < 3; i++)
    {
        vec3 o = vec3(i == 0 ? u_texel.x : 0.0, i == 1 ? u_texel.y : 0.0, i == 2 ? u_texel.z : 0.0);
        r[i] = (texture(u_field, x + o).r - texture(u_field, x - o).r) * 0.5 / u_texel[i];
    }
    return r;
}

void main()
{
    vec3 w = normalize(f_dir);
    vec3 q = (max(sign(w), 0.0) - f_entry) / w;
    float end = min(q.x, min(q.y, q.z));
    vec3 sum = vec3(0.0);
    float through = 1.0;
    for (float s = 0.5 * u_ds; s < end; s += u_ds)
    {
        vec3 x = f_entry + s * w;
        vec4 m = texture(u_map, vec2(texture(u_field, x).r, 0.5));
        vec3 g = nabla(x);
        float slope = length(g);
        float lit = 0.25 + 0.85 * abs(dot(g, w)) / max(slope, 1e-5);
        float sure = smoothstep(u_slopes.x, u_slopes.y, slope);
        m.rgb *= mix(0.8, lit, sure);
        sum += through * m.a * m.rgb;
        through *= 1.0 - m.a;
    }
    o_colour = vec4(sum, 1.0 - through);
}
)");
            const VertexBuffer vertices(canvas);
            const Field hills = [](float x, float y, float z) {
              const float height = 0.5F + 0.12F * std::sin(8 * x + 2 * z) + 0.1F * std::sin(9 * z - 3 * x);
              const float layers = 0.5F + 0.45F * std::tanh((3 + 5 * x) * (height - y));
              return std::clamp(layers + 0.05F * std::sin(20 * y + 7 * x) * std::sin(15 * z), 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float middle = std::exp(-std::pow((at - 0.5F) / 0.16F, 2.0F));
              const float ground = std::clamp((at - 0.7F) / 0.2F, 0.0F, 1.0F);
              table.push_back({static_cast<std::uint8_t>(200 - 40 * at),
                               static_cast<std::uint8_t>(110 + 100 * middle),
                               static_cast<std::uint8_t>(60 + 150 * (1 - at)),
                               static_cast<std::uint8_t>(std::lround(22 * middle + 24 * ground))});
            }
            upload_volume(canvas, 0, sampled(64, 48, 64, hills), {.texel = Texel::float32});
            upload_table_2d(canvas, 1, table);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 60, .elevation = 40, .distance = 2.6F, .degrees_each_frame = 1};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.05F, 0.07F, 0.1F);
              program.use();
              program.set("u_clipFromWorld", camera.clip_from_object());
              program.set("u_eye", camera.eye);
              program.set("u_field", 0);
              program.set("u_map", 1);
              program.set("u_ds", 0.016F);
              program.set("u_texel", Vector{1 / 64.0F, 1 / 48.0F, 1 / 64.0F});
              canvas.gl.Uniform2f(program.location("u_slopes"), 0.2F, 1.2F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
