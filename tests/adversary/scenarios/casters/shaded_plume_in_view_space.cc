// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario shaded_plume_in_view_space() {
  return {.sentence =
              "Temperatures of a plume, 80 x 80 x 40 floats in Kelvin whose slices lie farther apart, GLSL "
              "4.50: normals of 1 / textureSize() turned into the camera's space, both sides lit, nothing "
              "ambient, colours by formula.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 texcoord_in;
uniform mat4 model_view;
uniform mat4 projection;
out VertexData {
  vec3 texcoord;
  vec3 view_pos;
} vs;
void main() {
  vec4 v = model_view * vec4(texcoord_in, 1.0);
  vs.texcoord = texcoord_in;
  vs.view_pos = v.xyz;
  gl_Position = projection * v;
}
)",
                                      R"(#version 450 core
in VertexData {
  vec3 texcoord;
  vec3 view_pos;
} fs;
uniform sampler3D temperature;
uniform mat4 model_view;
uniform float t_cold;
uniform float t_hot;
uniform float sample_spacing;
uniform float density_factor;
layout(location = 0) out vec4 frag;

float kelvin(vec3 p) { return textureLod(temperature, p, 0.0).r; }

vec4 heat(float k) {
  float h = clamp((k - t_cold) / (t_hot - t_cold), 0.0, 1.0);
  vec3 c = clamp(vec3(2.2 * h, 2.2 * h * h + 0.1, 1.0 - 1.3 * h), 0.05, 1.0);
  float a = h < 0.2 ? 0.0 : density_factor * (h - 0.2) * (h - 0.2);
  return vec4(c, a);
}

vec3 view_normal(vec3 p, mat3 normal_matrix) {
  vec3 px = 1.0 / vec3(textureSize(temperature, 0));
  vec3 g = vec3(kelvin(p + vec3(px.x, 0, 0)) - kelvin(p - vec3(px.x, 0, 0)),
                kelvin(p + vec3(0, px.y, 0)) - kelvin(p - vec3(0, px.y, 0)),
                kelvin(p + vec3(0, 0, px.z)) - kelvin(p - vec3(0, 0, px.z))) / (2.0 * px);
  g = normal_matrix * g;
  float l = dot(g, g);
  return l > 1e-8 ? g * inversesqrt(l) : vec3(0.0);
}

void main() {
  mat3 object_from_view = inverse(mat3(model_view));
  mat3 normal_matrix = transpose(object_from_view);
  vec3 to_eye = -normalize(fs.view_pos);
  vec3 ray = object_from_view * -to_eye;

  vec3 t1 = (0.0 - fs.texcoord) / ray, t2 = (1.0 - fs.texcoord) / ray;
  vec3 tm = max(t1, t2);
  float reach = min(tm.x, min(tm.y, tm.z));
  int samples = int(ceil(reach / sample_spacing));

  vec4 sum = vec4(0.0);
  for (int s = 0; s < samples; ++s) {
    vec3 p = fs.texcoord + (float(s) * sample_spacing) * ray;
    vec4 c = heat(kelvin(p));
    if (c.a <= 0.0) continue;
    vec3 n = view_normal(p, normal_matrix);
    float nv = abs(dot(n, to_eye));
    c.rgb = 0.85 * nv * c.rgb + 0.25 * pow(nv, 32.0);
    sum += (1.0 - sum.a) * c.a * vec4(c.rgb, 1.0);
  }
  frag = sum;
}
)");
            const VertexBuffer vertices(canvas);
            const Field plume = [](float x, float y, float z) {
              const float u = x - 0.5F - 0.1F * std::sin(7 * y), v = z - 0.5F - 0.12F * std::cos(6 * y + 1);
              const float width = 0.24F + 0.2F * y * y + 0.06F * std::sin(17 * y + 3 * std::atan2(v, u));
              const float square = u * u + v * v;
              return 290 + 75 * std::exp(-square / (width * width)) * (1.1F - 0.5F * y) +
                     2 * std::sin(12 * x) * std::sin(9 * z);
            };
            upload_volume(canvas, 0, sampled(80, 80, 40, plume), {.texel = Texel::float32});
            return [&canvas, program, vertices](int frame) {
              constexpr float thickness = 0.75F;  // 40 slices, 1.5 apart
              const Orbit orbit{.azimuth = 45, .elevation = 15, .distance = 2.3F, .degrees_each_frame = 1.25F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              const Matrix model{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, thickness, 0, 0, 0, 0.5F - 0.5F * thickness, 1};
              canvas.begin(0.02F, 0.02F, 0.05F);
              program.use();
              program.set("model_view", camera.view * model);
              program.set("projection", camera.projection);
              program.set("temperature", 0);
              program.set("t_cold", 290.0F);
              program.set("t_hot", 365.0F);
              program.set("sample_spacing", 0.0125F);
              program.set("density_factor", 0.4F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
