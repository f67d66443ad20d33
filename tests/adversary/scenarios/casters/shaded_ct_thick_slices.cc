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

Scenario shaded_ct_thick_slices() {
  return {.sentence =
              "A tomograph's 12 of 16 bits in 26 slices of twice the pixels' distance, GLSL 1.50: a head "
              "with diffuse and specular light from the eye, one-sided, nothing ambient; colours and "
              "opacities in two tables of floats.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 150
in vec3 position;
uniform mat4 in_modelViewProjection;
uniform vec3 in_volumeSize;
out vec3 ip_vertexPos;
out vec3 ip_textureCoords;
void main()
{
  ip_textureCoords = position;
  ip_vertexPos = position * in_volumeSize;
  gl_Position = in_modelViewProjection * vec4(ip_vertexPos, 1.0);
}
)",
                                      R"(#version 150
in vec3 ip_vertexPos;
in vec3 ip_textureCoords;

uniform sampler3D in_volume;
uniform sampler2D in_colorTransferFunc;
uniform sampler2D in_opacityTransferFunc;

uniform vec3 in_cameraPosObj;
uniform vec3 in_volumeSize;
uniform vec3 in_cellStep;
uniform vec3 in_cellSpacing;
uniform float in_volume_scale;
uniform float in_volume_bias;
uniform float in_sampleDistance;
uniform float in_diffuse;
uniform float in_specular;
uniform float in_shininess;

out vec4 fragOutput0;

const float g_opacityThreshold = 1.0 - 1.0 / 255.0;
vec3 g_rayDir;
vec3 g_dirStep;
vec3 g_dataPos;
vec4 g_fragColor;

vec4 computeGradient(in vec3 texPos)
{
  vec3 xvec = vec3(in_cellStep.x, 0.0, 0.0);
  vec3 yvec = vec3(0.0, in_cellStep.y, 0.0);
  vec3 zvec = vec3(0.0, 0.0, in_cellStep.z);
  vec3 g1;
  vec3 g2;
  g1.x = texture(in_volume, texPos + xvec).x;
  g1.y = texture(in_volume, texPos + yvec).x;
  g1.z = texture(in_volume, texPos + zvec).x;
  g2.x = texture(in_volume, texPos - xvec).x;
  g2.y = texture(in_volume, texPos - yvec).x;
  g2.z = texture(in_volume, texPos - zvec).x;
  g1 = g1 * in_volume_scale + in_volume_bias;
  g2 = g2 * in_volume_scale + in_volume_bias;

  g1 = (g2 - g1) / in_cellSpacing;
  float grad_mag = length(g1);
  if (grad_mag > 0.0)
    g1 /= grad_mag;
  else
    g1 = vec3(0.0);
  return vec4(g1, grad_mag);
}

vec4 computeLighting(vec4 color)
{
  vec3 normal = computeGradient(g_dataPos).xyz;
  vec3 ldir = -g_rayDir;
  vec3 vdir = -g_rayDir;
  vec3 diffuse = vec3(0.0);
  vec3 specular = vec3(0.0);
  float nDotL = dot(normal, ldir);
  vec3 r = normalize(2.0 * nDotL * normal - ldir);
  float vDotR = max(dot(r, vdir), 0.0);
  if (nDotL > 0.0)
  {
    diffuse = nDotL * in_diffuse * color.rgb;
    specular = vec3(pow(vDotR, in_shininess) * in_specular);
  }
  return vec4(diffuse + specular, color.a);
}

vec4 computeColor(float scalar)
{
  float opacity = texture(in_opacityTransferFunc, vec2(scalar, 0.5)).r;
  vec3 color = texture(in_colorTransferFunc, vec2(scalar, 0.5)).rgb;
  return computeLighting(vec4(color, opacity));
}

void main()
{
  g_fragColor = vec4(0.0);
  g_rayDir = normalize(ip_vertexPos - in_cameraPosObj);
  g_dirStep = in_sampleDistance * g_rayDir / in_volumeSize;
  g_dataPos = ip_textureCoords;
  bool exit = false;
  while (!exit)
  {
    float scalar = texture(in_volume, g_dataPos).r;
    scalar = scalar * in_volume_scale + in_volume_bias;
    vec4 srcColor = computeColor(scalar);
    srcColor.rgb *= srcColor.a;
    g_fragColor = (1.0 - g_fragColor.a) * srcColor + g_fragColor;

    g_dataPos += g_dirStep;
    exit = any(greaterThan(g_dataPos, vec3(1.0))) || any(lessThan(g_dataPos, vec3(0.0))) ||
           g_fragColor.a > g_opacityThreshold;
  }
  fragOutput0 = g_fragColor;
}
)");
            const VertexBuffer vertices(canvas);
            const Field head = [](float x, float y, float z) {
              const float u = x - 0.5F, v = 0.94F * (y - 0.5F), w = 1.05F * (z - 0.48F);
              const float radius = std::sqrt(u * u + v * v + w * w) *
                                   (1 - 0.12F * w + 0.05F * std::sin(9 * u + 4 * v) * std::cos(8 * v - 5 * w));
              const float skull = 0.62F * std::exp(-std::pow((radius - 0.36F) / 0.035F, 2.0F));
              const float eyes = std::exp(-90 * (std::pow(std::abs(u) - 0.16F, 2.0F) +
                                                 std::pow(v - 0.08F, 2.0F) + std::pow(w - 0.32F, 2.0F)));
              const float tissue = 0.3F / (1 + std::exp((radius - 0.44F) / 0.012F));
              const float folds =
                  0.06F * std::sin(26 * x + 5 * y) * std::sin(24 * y - 3 * z) * std::sin(21 * z);
              return std::clamp(tissue + skull * (1 - 0.9F * eyes) + (radius < 0.3F ? folds : 0), 0.0F, 1.0F);
            };
            upload_volume(canvas, 0, scaled(sampled(64, 64, 26, head), 4095.0F / 65535),
                          {.texel = Texel::unsigned16});
            constexpr int entries = 512;
            std::vector<float> colours, opacities;
            for (int i = 0; i < entries; ++i) {
              const float at = static_cast<float>(i) / (entries - 1);
              const float bone = std::clamp((at - 0.38F) / 0.16F, 0.0F, 1.0F);
              colours.insert(colours.end(), {0.8F + 0.2F * bone, 0.45F + 0.5F * bone, 0.32F + 0.53F * bone});
              opacities.push_back(0.05F * std::exp(-std::pow((at - 0.17F) / 0.07F, 2.0F)) + 0.32F * bone);
            }
            const auto upload = [&](int unit, GLint internal, GLenum format, const std::vector<float>& values) {
              GLuint name = 0;
              canvas.gl.GenTextures(1, &name);
              canvas.gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
              canvas.gl.BindTexture(GL_TEXTURE_2D, name);
              filter_linearly(canvas, GL_TEXTURE_2D);
              canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, internal, entries, 1, 0, format, GL_FLOAT, values.data());
            };
            upload(1, GL_RGB32F, GL_RGB, colours);
            upload(2, GL_R32F, GL_RED, opacities);
            return [&canvas, program, vertices](int frame) {
              constexpr Vector size{64, 64, 52};  // mm
              const Orbit orbit{.azimuth = 20, .elevation = 12, .distance = 2.3F, .degrees_each_frame = 2};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              const Vector offset{0.5F - size.x / 128, 0.5F - size.y / 128, 0.5F - size.z / 128};
              const Matrix model{1 / 64.0F, 0, 0,         0, 0,        1 / 64.0F, 0,        0,
                                 0,         0, 1 / 64.0F, 0, offset.x, offset.y,  offset.z, 1};
              canvas.begin(0.2F, 0.2F, 0.25F);
              program.use();
              program.set("in_modelViewProjection", camera.clip_from_object() * model);
              program.set("in_cameraPosObj", 64.0F * (camera.eye - offset));
              program.set("in_volumeSize", size);
              program.set("in_cellStep", Vector{1 / 64.0F, 1 / 64.0F, 1 / 26.0F});
              program.set("in_cellSpacing", Vector{1, 1, 2});
              program.set("in_volume", 0);
              program.set("in_colorTransferFunc", 1);
              program.set("in_opacityTransferFunc", 2);
              program.set("in_volume_scale", 65535.0F / 4095);
              program.set("in_volume_bias", 0.0F);
              program.set("in_sampleDistance", 0.8F);
              program.set("in_diffuse", 0.9F);
              program.set("in_specular", 0.25F);
              program.set("in_shininess", 12.0F);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
