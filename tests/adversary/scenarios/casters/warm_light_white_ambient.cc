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

Scenario warm_light_white_ambient() {
  return {
      .sentence =
          "Roots of 48 x 32 x 40 floats in GLSL 4.10, camera and light in a uniform block, drawn by "
          "the back faces: Blinn's and Phong's light from the eye, whose warm colour multiplies "
          "diffuse and highlight, while ambient is white; normals over one texel, normalised where "
          "they are not zero.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 410 core

layout (std140) uniform Scene
{
  mat4 viewProjection;
  vec4 cameraPosition;
  vec4 lampColor;
};

layout (location = 0) in vec3 corner;
layout (location = 0) out vec3 texturePosition;

void main ()
{
  texturePosition = corner;
  gl_Position = viewProjection * vec4 (corner, 1.0);
}
)",
                                  R"(#version 410 core

layout (std140) uniform Scene
{
  mat4 viewProjection;
  vec4 cameraPosition;
  vec4 lampColor;
};

uniform sampler3D rootsSampler;
uniform sampler2D lutSampler;
uniform float sampleStep;

layout (location = 0) in vec3 texturePosition;
layout (location = 0) out vec4 color;

vec3 gradientAt (vec3 p)
{
  ivec3 size = textureSize (rootsSampler, 0);
  vec3 dx = vec3 (1.0 / float (size.x), 0.0, 0.0);
  vec3 dy = vec3 (0.0, 1.0 / float (size.y), 0.0);
  vec3 dz = vec3 (0.0, 0.0, 1.0 / float (size.z));
  vec3 ahead = vec3 (texture (rootsSampler, p + dx).r, texture (rootsSampler, p + dy).r,
                     texture (rootsSampler, p + dz).r);
  vec3 behind = vec3 (texture (rootsSampler, p - dx).r, texture (rootsSampler, p - dy).r,
                      texture (rootsSampler, p - dz).r);
  return 0.5 * (ahead - behind);
}

void main ()
{
  const float ambient = 0.25;
  const float diffuse = 0.65;
  const float specular = 0.3;

  vec3 o = cameraPosition.xyz;
  vec3 d = normalize (texturePosition - o);
  vec3 p0 = (vec3 (0.0) - o) / d;
  vec3 p1 = (vec3 (1.0) - o) / d;
  vec3 pMin = min (p0, p1);
  vec3 pMax = max (p0, p1);
  float t = max (max (pMin.x, pMin.y), pMin.z);
  float end = min (min (pMax.x, pMax.y), pMax.z);
  t = max (t, 0.0);

  vec4 accumulated = vec4 (0.0);
  for (; t < end; t += sampleStep)
  {
    vec3 p = o + t * d;
    vec4 material = texture (lutSampler, vec2 (texture (rootsSampler, p).r, 0.5));

    vec3 g = gradientAt (p);
    float magnitude = length (g);
    vec3 normal = magnitude > 0.0 ? -g / magnitude : vec3 (0.0);
    vec3 toCamera = -d;
    vec3 toLamp = toCamera;
    vec3 halfVector = normalize (toLamp + toCamera);
    float lambert = max (dot (normal, toLamp), 0.0);
    float gloss = pow (max (dot (normal, halfVector), 0.0), 20.0);

    vec3 shaded = ambient * material.rgb;
    shaded += lampColor.rgb * (diffuse * lambert * material.rgb + specular * gloss);

    material = vec4 (shaded * material.a, material.a);
    accumulated += material * (1.0 - accumulated.a);
  }
  color = accumulated;
}
)");
        const VertexBuffer vertices(canvas);
        const Field roots = [](float x, float y, float z) {
          const float spread = 0.4F - 0.25F * y;
          const float a = x - 0.5F - spread * std::sin(3 * y + 0.4F), b = z - 0.4F - 0.5F * spread * (1 - y);
          const float c = x - 0.42F + 0.7F * spread * (1 - y), d = z - 0.6F - 0.3F * spread * std::cos(5 * y);
          return std::clamp(0.1F + 0.7F * std::exp(-16 * (a * a + b * b)) +
                                0.6F * std::exp(-19 * (c * c + d * d)) + 0.05F * std::sin(14 * y + 5 * x),
                            0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float bark = std::exp(-std::pow((at - 0.55F) / 0.16F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(150 + 60 * at), static_cast<std::uint8_t>(190 - 70 * bark),
                           static_cast<std::uint8_t>(170 - 100 * bark),
                           static_cast<std::uint8_t>(std::lround(42 * bark + 8 * at))});
        }
        upload_volume(canvas, 0, sampled(48, 32, 40, roots), {.texel = Texel::float32});
        upload_table_2d(canvas, 1, table);
        GLuint scene = 0;
        canvas.gl.GenBuffers(1, &scene);
        canvas.gl.UniformBlockBinding(program.name(), canvas.gl.GetUniformBlockIndex(program.name(), "Scene"),
                                      2);
        program.use();
        program.set("rootsSampler", 0);
        program.set("lutSampler", 1);
        program.set("sampleStep", 0.02F);
        return [&canvas, program, vertices, scene](int frame) {
          const Orbit orbit{.azimuth = 330, .elevation = 15, .distance = 2.3F, .degrees_each_frame = 1};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.06F, 0.06F, 0.08F);
          const Matrix view_projection = camera.clip_from_object();
          std::vector<float> numbers(view_projection.begin(), view_projection.end());
          numbers.insert(numbers.end(), {camera.eye.x, camera.eye.y, camera.eye.z, 1, 1, 0.93F, 0.8F, 1});
          canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, scene);
          canvas.gl.BufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(numbers.size() * sizeof(float)),
                               numbers.data(), GL_STREAM_DRAW);
          canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 2, scene);
          program.use();
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_FRONT);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
