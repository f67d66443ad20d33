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

Scenario shaded_gloss_in_upper_half() {
  return {.sentence =
              "A pear of 60 x 60 x 60 texels of 16 bits, Blinn's light from the eye, GLSL 1.50; it is wet, "
              "with a highlight, only where z is above 0.55, and dull below.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 150 core
in vec3 position;
uniform mat4 worldViewProj;
out vec3 uvw;
void main()
{
    uvw = position;
    gl_Position = worldViewProj * vec4(position, 1.0);
}
)",
                                      R"(#version 150 core
in vec3 uvw;
out vec4 pixel;
uniform sampler3D scalarField;
uniform sampler2D transferTex;
uniform vec3 cameraInObject;
uniform float stepSize;
uniform float wetAbove;

struct Material { float ka, kd, ks, gloss; };
const Material dull = Material(0.3, 0.7, 0.0, 1.0);
const Material wet = Material(0.3, 0.7, 0.5, 14.0);

vec3 centralDifferences(vec3 p)
{
    vec3 h = 1.0 / vec3(textureSize(scalarField, 0));
    vec3 a, b;
    a.x = texture(scalarField, vec3(p.x + h.x, p.y, p.z)).r;
    b.x = texture(scalarField, vec3(p.x - h.x, p.y, p.z)).r;
    a.y = texture(scalarField, vec3(p.x, p.y + h.y, p.z)).r;
    b.y = texture(scalarField, vec3(p.x, p.y - h.y, p.z)).r;
    a.z = texture(scalarField, vec3(p.x, p.y, p.z + h.z)).r;
    b.z = texture(scalarField, vec3(p.x, p.y, p.z - h.z)).r;
    return a - b;
}

vec3 blinn(vec3 base, vec3 n, vec3 l, vec3 v, Material m)
{
    float diffuse = max(dot(n, l), 0.0);
    float specular = pow(max(dot(n, normalize(l + v)), 0.0), m.gloss);
    return base * (m.ka + m.kd * diffuse) + m.ks * specular;
}

void main()
{
    vec3 ray = normalize(uvw - cameraInObject);
    vec3 leave = (step(0.0, ray) - uvw) / ray;
    int steps = int(min(leave.x, min(leave.y, leave.z)) / stepSize) + 1;
    vec4 front = vec4(0.0);
    for (int i = 0; i < steps; ++i)
    {
        vec3 p = uvw + ray * (float(i) * stepSize);
        float s = texture(scalarField, p).r;
        vec4 c = texture(transferTex, vec2(s, 0.5));
        if (c.a > 0.001)
        {
            vec3 g = centralDifferences(p);
            vec3 n = length(g) > 1e-5 ? -normalize(g) : vec3(0.0);
            Material m = dull;
            if (p.z > wetAbove) m = wet;
            c.rgb = blinn(c.rgb, n, -ray, -ray, m);
            front.rgb += (1.0 - front.a) * c.a * c.rgb;
            front.a += (1.0 - front.a) * c.a;
        }
    }
    pixel = front;
}
)");
            const VertexBuffer vertices(canvas);
            const Field pear = [](float x, float y, float z) {
              const float u = x - 0.5F, v = y - 0.45F, w = z - 0.5F;
              const float slim = 1 + 0.9F * std::clamp(v + 0.1F, 0.0F, 1.0F);
              const float radius = std::sqrt(slim * slim * (u * u + w * w) + 0.75F * v * v);
              const float bumps =
                  0.02F * std::sin(25 * x) * std::sin(27 * z + 5 * y) + 0.02F * std::sin(19 * y);
              return std::clamp(1 - 1.9F * radius + bumps, 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float flesh = std::clamp((at - 0.2F) / 0.1F, 0.0F, 1.0F);
              const float seeds = std::clamp((at - 0.75F) / 0.1F, 0.0F, 1.0F);
              table.push_back({static_cast<std::uint8_t>(160 + 60 * flesh - 120 * seeds),
                               static_cast<std::uint8_t>(190 - 90 * seeds), static_cast<std::uint8_t>(70),
                               static_cast<std::uint8_t>(std::lround(30 * flesh * (1 - at) + 120 * seeds))});
            }
            upload_volume(canvas, 0, sampled(60, pear), {.texel = Texel::unsigned16});
            upload_table_2d(canvas, 1, table);
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 80, .elevation = 10, .distance = 2.1F, .degrees_each_frame = -2};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.25F, 0.22F, 0.2F);
              program.use();
              program.set("worldViewProj", camera.clip_from_object());
              program.set("cameraInObject", camera.eye);
              program.set("scalarField", 0);
              program.set("transferTex", 1);
              program.set("stepSize", 0.0167F);
              program.set("wetAbove", 0.55F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
