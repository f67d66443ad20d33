// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario fades_chest_vtk_1024() {
  return {.sentence =
              "A chest in 12 of 16 bits and 24 thick slices, GLSL 1.50 as VTK writes it: colours, opacities "
              "and gradient opacities in three tables of 1024 floats, the gradient's length by a quarter of "
              "the scalars' range, Blinn-Phong from the eye. What is even does not show.",
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
uniform sampler2D in_gradientTransferFunc;

uniform vec3 in_cameraPosObj;
uniform vec3 in_volumeSize;
uniform vec3 in_cellStep;
uniform vec3 in_cellSpacing;
uniform vec2 in_scalarsRange;
uniform float in_volume_scale;
uniform float in_volume_bias;
uniform float in_sampleDistance;
uniform float in_ambient;
uniform float in_diffuse;
uniform float in_specular;
uniform float in_shininess;

out vec4 fragOutput0;

const float g_opacityThreshold = 1.0 - 1.0 / 255.0;
vec3 g_rayDir;
vec3 g_dirStep;
vec3 g_dataPos;
vec4 g_fragColor;
vec4 g_srcColor;

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

  float range = in_scalarsRange.y - in_scalarsRange.x;
  g1 = in_scalarsRange.x + range * g1;
  g2 = in_scalarsRange.x + range * g2;

  g2 = g1 - g2;
  float avgSpacing = (in_cellSpacing.x + in_cellSpacing.y + in_cellSpacing.z) / 3.0;
  vec3 aspect = in_cellSpacing * 2.0 / avgSpacing;
  g2 /= aspect;
  float grad_mag = length(g2);
  g2 = grad_mag > 0.0 ? normalize(g2) : vec3(0.0);

  range = range != 0.0 ? range : 1.0;
  grad_mag = grad_mag / (0.25 * range);
  grad_mag = clamp(grad_mag, 0.0, 1.0);
  return vec4(g2, grad_mag);
}

float computeGradientOpacity(vec4 grad)
{
  return texture(in_gradientTransferFunc, vec2(grad.w, 0.0)).r;
}

vec4 computeLighting(vec4 color)
{
  vec4 finalColor = vec4(0.0);
  vec4 gradient = computeGradient(g_dataPos);
  vec3 diffuse = vec3(0.0);
  vec3 specular = vec3(0.0);
  vec3 normal = -gradient.xyz;
  vec3 ldir = -g_rayDir;
  vec3 h = normalize(ldir - g_rayDir);
  float nDotL = dot(normal, ldir);
  float nDotH = dot(normal, h);
  if (nDotL > 0.0)
  {
    diffuse = nDotL * in_diffuse * color.rgb;
    specular = vec3(pow(max(nDotH, 0.0), in_shininess) * in_specular);
  }
  finalColor.rgb = in_ambient * color.rgb + diffuse + specular;
  color.a *= computeGradientOpacity(gradient);
  finalColor.a = color.a;
  return finalColor;
}

float computeOpacity(float scalar)
{
  return texture(in_opacityTransferFunc, vec2(scalar, 0.5)).r;
}

vec4 computeColor(float scalar, float opacity)
{
  return computeLighting(vec4(texture(in_colorTransferFunc, vec2(scalar, 0.5)).rgb, opacity));
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
    g_srcColor = vec4(0.0);
    g_srcColor.a = computeOpacity(scalar);
    if (g_srcColor.a > 0.0)
    {
      g_srcColor = computeColor(scalar, g_srcColor.a);
      g_srcColor.rgb *= g_srcColor.a;
      g_fragColor = (1.0 - g_fragColor.a) * g_srcColor + g_fragColor;
    }

    g_dataPos += g_dirStep;
    exit = any(greaterThan(g_dataPos, vec3(1.0))) || any(lessThan(g_dataPos, vec3(0.0))) ||
           g_fragColor.a > g_opacityThreshold;
  }
  fragOutput0 = g_fragColor;
}
)");
            const VertexBuffer vertices(canvas);
            const Field chest = [](float x, float y, float z) {
              const float u = x - 0.5F, v = y - 0.5F, w = z - 0.5F;
              const float wavy = 0.012F * std::sin(11 * w + 3 * u);
              const float radius = std::sqrt(u * u + 1.4F * v * v + 0.35F * w * w) + wavy;
              const float tissue = 0.3F / (1 + std::exp((radius - 0.41F) / 0.022F));
              const float between = 0.5F + 0.5F * std::sin(27 * z + 6 * u);
              const float ribs = 0.52F * between * std::exp(-std::pow((radius - 0.3F) / 0.035F, 2.0F));
              const float beside = std::sqrt(std::pow(x - 0.44F, 2.0F) + std::pow(y - 0.52F, 2.0F) +
                                             0.7F * std::pow(z - 0.55F, 2.0F));
              const float heart = 0.2F / (1 + std::exp((beside - 0.14F) / 0.015F));
              return std::clamp(tissue + ribs + heart, 0.0F, 1.0F);
            };
            upload_volume(canvas, 0, scaled(sampled(56, 48, 24, chest), 4095.0F / 65535),
                          {.texel = Texel::unsigned16});
            constexpr int entries = 1024;
            std::vector<float> colours, opacities, factors;
            for (int i = 0; i < entries; ++i) {
              const float at = static_cast<float>(i) / (entries - 1);
              const float bone = std::clamp((at - 0.52F) / 0.12F, 0.0F, 1.0F);
              const float flesh = std::clamp((at - 0.28F) / 0.14F, 0.0F, 1.0F);
              const float green = 0.7F - 0.45F * flesh + 0.65F * bone;
              const float blue = 0.5F - 0.3F * flesh + 0.6F * bone;
              colours.insert(colours.end(), {0.85F + 0.1F * bone, green, blue});
              opacities.push_back(0.2F * std::exp(-std::pow((at - 0.15F) / 0.06F, 2.0F)) +
                                  0.3F * std::exp(-std::pow((at - 0.43F) / 0.06F, 2.0F)) + 0.45F * bone);
              const float rise = std::clamp(3 * (at - 0.08F), 0.0F, 0.66F);
              factors.push_back(rise + std::clamp(0.9F * (at - 0.3F), 0.0F, 0.34F));
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
            upload(3, GL_R32F, GL_RED, factors);
            return [&canvas, program, vertices](int frame) {
              constexpr Vector size{56, 48, 48};  // mm
              const Orbit orbit{.azimuth = 35, .elevation = 18, .distance = 2.3F, .degrees_each_frame = 2};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              const Vector offset{0.5F - size.x / 112, 0.5F - size.y / 112, 0.5F - size.z / 112};
              const Matrix model{1 / 56.0F, 0, 0,         0, 0,        1 / 56.0F, 0,        0,
                                 0,         0, 1 / 56.0F, 0, offset.x, offset.y,  offset.z, 1};
              canvas.begin(0.2F, 0.2F, 0.25F);
              program.use();
              program.set("in_modelViewProjection", camera.clip_from_object() * model);
              program.set("in_cameraPosObj", 56.0F * (camera.eye - offset));
              program.set("in_volumeSize", size);
              program.set("in_cellStep", Vector{1 / 56.0F, 1 / 48.0F, 1 / 24.0F});
              program.set("in_cellSpacing", Vector{1, 1, 2});
              canvas.gl.Uniform2f(program.location("in_scalarsRange"), 0.0F, 4095.0F);
              program.set("in_volume", 0);
              program.set("in_colorTransferFunc", 1);
              program.set("in_opacityTransferFunc", 2);
              program.set("in_gradientTransferFunc", 3);
              program.set("in_volume_scale", 65535.0F / 4095);
              program.set("in_volume_bias", 0.0F);
              program.set("in_sampleDistance", 0.8F);
              program.set("in_ambient", 0.25F);
              program.set("in_diffuse", 0.7F);
              program.set("in_specular", 0.2F);
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
