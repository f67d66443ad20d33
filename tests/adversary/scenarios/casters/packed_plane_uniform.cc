// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario packed_plane_uniform() {
  return {.sentence =
              "A sponge of 48 x 56 x 60 in 16 bits in GLSL 4.00. One vec4 goes from the vertex shader to the "
              "fragment shader: where the ray enters, and in w how far that is from a plane, a uniform of the "
              "vertex shader. Samples beyond it are left out. The plane stands just outside of the box "
              "until frame 7, and slides in slowly from frame 8 on, a little in every frame.",
          .expectation = Expectation::either,
          .key_frames = {8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 400 core
layout(location = 0) in vec3 aPosition;
uniform mat4 uClip;
uniform vec4 uPlane;

out vec4 vPacked;

void main()
{
    vPacked.xyz = aPosition;
    vPacked.w = dot(uPlane.xyz, aPosition) + uPlane.w;
    gl_Position = uClip * vec4(aPosition, 1.0);
}
)",
                                      R"(#version 400 core
uniform sampler3D uSponge;
uniform sampler1D uTransfer;
uniform vec3 uEye;
uniform float uStep;

in vec4 vPacked;
layout(location = 0) out vec4 oColour;

const vec3 kNormal = vec3(0.28, 0.0, 0.96);

void main()
{
    vec3 dir = normalize(vPacked.xyz - uEye);
    vec3 far = mix(-vPacked.xyz, 1.0 - vPacked.xyz, greaterThan(dir, vec3(0.0))) / dir;
    float leave = min(far.x, min(far.y, far.z));

    // Place and distance advance together.
    vec4 perStep = uStep * vec4(dir, dot(kNormal, dir));
    vec4 p = vPacked;
    vec3 light = vec3(0.0);
    float passed = 1.0;
    for (float t = 0.0; t < leave; t += uStep, p += perStep)
    {
        if (p.w < 0.0)
            continue;
        vec4 src = texture(uTransfer, texture(uSponge, p.xyz).r);
        light += passed * src.a * src.rgb;
        passed *= 1.0 - src.a;
    }
    oColour = vec4(light, 1.0 - passed);
}
)");
            const VertexBuffer vertices(canvas);
            const Field sponge = [](float x, float y, float z) {
              const float sum = std::sin(12 * x + 1) * std::cos(10 * y) +
                                std::sin(11 * y) * std::cos(13 * z + 2) +
                                std::sin(12 * z) * std::cos(11 * x - 2 * y);
              return std::clamp(0.46F + 0.27F * sum + 0.12F * (y - x * z), 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float flesh = std::clamp((at - 0.42F) / 0.4F, 0.0F, 1.0F);
              table.push_back({static_cast<std::uint8_t>(150 + 100 * flesh),
                               static_cast<std::uint8_t>(70 + 140 * at),
                               static_cast<std::uint8_t>(120 - 90 * std::sin(3 * at)),
                               static_cast<std::uint8_t>(std::lround(1 + 3 * at + 40 * flesh * flesh))});
            }
            upload_volume(canvas, 0, sampled(48, 56, 60, sponge), {.texel = Texel::unsigned16});
            upload_table_1d(canvas, 1, table);
            program.use();
            program.set("uSponge", 0);
            program.set("uTransfer", 1);
            program.set("uStep", 0.0165F);
            return [&canvas, program, vertices](int frame) {
              const Camera camera =
                  camera_at({.azimuth = 172, .elevation = -18, .distance = 2.45F, .degrees_each_frame = 1.5F},
                            frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              const float plane = 0.03F * static_cast<float>(std::max(frame - 7, 0)) - 0.02F;
              canvas.begin(0.06F, 0.12F, 0.18F);
              program.use();
              program.set("uClip", camera.clip_from_object());
              program.set("uEye", camera.eye);
              canvas.gl.Uniform4f(program.location("uPlane"), 0.28F, 0, 0.96F, -plane);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
