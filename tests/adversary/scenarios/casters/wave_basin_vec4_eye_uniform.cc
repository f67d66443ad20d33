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

Scenario wave_basin_vec4_eye_uniform() {
  return {
      .sentence =
          "A basin of 48 x 48 x 40 bytes in GLSL 3.30: the vertex shader gives vertex minus eye, the eye is a "
          "vec4 uniform of both shaders, Lambert's and Phong's light from the eye, rays end at 0.9, and part "
          "of "
          "the table is edited at frame 9, all of it at frame 18.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {9, 18},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 vertexPosition;

uniform mat4 viewProjection;
uniform vec4 eyePosition;

out vec3 rayDirection;

void main()
{
    rayDirection = vertexPosition - eyePosition.xyz;
    gl_Position = viewProjection * vec4(vertexPosition, 1.0);
}
)",
                                  R"(#version 330 core
uniform sampler3D volumeTexture;
uniform sampler2D transferFunction;
uniform vec4 eyePosition;
uniform float stepSize;

in vec3 rayDirection;
out vec4 fragmentColour;

const float AMBIENT = 0.3;
const float DIFFUSE = 0.6;
const float SPECULAR = 0.3;

bool hitBox(vec3 origin, vec3 direction, out float tNear, out float tFar)
{
    vec3 towardsLow = (vec3(0.0) - origin) / direction;
    vec3 towardsHigh = (vec3(1.0) - origin) / direction;
    vec3 low = min(towardsLow, towardsHigh);
    vec3 high = max(towardsLow, towardsHigh);
    tNear = max(max(low.x, low.y), max(low.z, 0.0));
    tFar = min(high.x, min(high.y, high.z));
    return tNear < tFar;
}

vec3 normalAt(vec3 p)
{
    vec3 d = 1.0 / vec3(textureSize(volumeTexture, 0));
    vec3 gradient;
    gradient.x = texture(volumeTexture, p + vec3(d.x, 0.0, 0.0)).r - texture(volumeTexture, p - vec3(d.x, 0.0, 0.0)).r;
    gradient.y = texture(volumeTexture, p + vec3(0.0, d.y, 0.0)).r - texture(volumeTexture, p - vec3(0.0, d.y, 0.0)).r;
    gradient.z = texture(volumeTexture, p + vec3(0.0, 0.0, d.z)).r - texture(volumeTexture, p - vec3(0.0, 0.0, d.z)).r;
    return -gradient / max(length(gradient), 1e-4);
}

void main()
{
    vec3 direction = normalize(rayDirection);
    direction = mix(direction, vec3(1e-6), lessThan(abs(direction), vec3(1e-6)));
    float tNear, tFar;
    if (!hitBox(eyePosition.xyz, direction, tNear, tFar))
        discard;

    vec4 result = vec4(0.0);
    for (float t = tNear; t < tFar; t += stepSize)
    {
        vec3 p = eyePosition.xyz + t * direction;
        vec4 classified = texture(transferFunction, vec2(texture(volumeTexture, p).r, 0.5));
        vec3 normal = normalAt(p);
        float cosine = max(dot(normal, -direction), 0.0);
        vec3 lit = classified.rgb * (AMBIENT + DIFFUSE * cosine) + vec3(SPECULAR * pow(cosine, 12.0));
        result.rgb += (1.0 - result.a) * classified.a * lit;
        result.a += (1.0 - result.a) * classified.a;
        if (result.a >= 0.9)
            break;
    }
    fragmentColour = result;
}
)");
        const VertexBuffer vertices(canvas);
        const Field basin = [](float x, float y, float z) {
          const float a = x - 0.55F, b = z - 0.45F;
          const float floor = 0.2F + 1.6F * (a * a + b * b) + 0.05F * std::sin(17 * x + 3) * std::cos(13 * z);
          return std::clamp(0.5F + 1.5F * (floor - y) + 0.08F * std::sin(21 * y + 5 * x), 0.0F, 1.0F);
        };
        const auto table_of = [](float red, float green, float blue, float skin_at) {
          std::vector<Colour> table;
          for (int i = 0; i < 256; ++i) {
            const float at = static_cast<float>(i) / 255;
            const float skin = std::exp(-std::pow((at - skin_at) / 0.12F, 2.0F));
            table.push_back({static_cast<std::uint8_t>(red * (0.5F + 0.4F * at)),
                             static_cast<std::uint8_t>(green * (0.9F - 0.5F * at)),
                             static_cast<std::uint8_t>(blue * (0.4F + 0.5F * at * at)),
                             static_cast<std::uint8_t>(std::lround(34 * skin + 26 * at * at))});
          }
          return table;
        };
        upload_volume(canvas, 0, sampled(48, 48, 40, basin));
        upload_table_2d(canvas, 1, table_of(240, 190, 110, 0.5F));
        program.use();
        program.set("volumeTexture", 0);
        program.set("transferFunction", 1);
        program.set("stepSize", 0.018F);
        return [&canvas, program, vertices, table_of](int frame) {
          if (frame == 9) {
            const auto colours = table_of(90, 220, 240, 0.45F);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 90, 0, 80, 1, GL_RGBA, GL_UNSIGNED_BYTE, &colours[90]);
          }
          if (frame == 18) {
            const auto colours = table_of(200, 120, 230, 0.35F);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
          }
          const Orbit orbit{.azimuth = 40, .elevation = 35, .distance = 2.3F, .degrees_each_frame = 1.5F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.08F, 0.1F, 0.14F);
          program.use();
          program.set("viewProjection", camera.clip_from_object());
          canvas.gl.Uniform4f(program.location("eyePosition"), camera.eye.x, camera.eye.y, camera.eye.z, 1);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
