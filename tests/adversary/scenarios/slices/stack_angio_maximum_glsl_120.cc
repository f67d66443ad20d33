// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {
namespace {

constexpr std::array<float, 3> angio_millimetres{120, 150, 96};

float vessels(float x, float y, float z) {
  float bright = 0.08F + 0.1F * waves(x, y, z);
  for (int i = 0; i < 5; ++i) {
    const float phase = 1.3F * static_cast<float>(i);
    const float u = x - (0.5F + 0.3F * std::sin(5 * z + phase)),
                v = y - (0.5F + 0.35F * std::cos(4 * z + 2 * phase));
    const float thick = 0.03F + 0.01F * static_cast<float>(i);
    bright = std::max(bright,
                      (0.35F + 0.13F * static_cast<float>(i)) * std::exp(-(u * u + v * v) / (thick * thick)));
  }
  return std::min(bright, 1.0F);
}

/// Blue rises and falls, so that the brightest sample is not the brightest colour.
std::vector<Colour> hot_metal() {
  std::vector<Colour> colours;
  for (int i = 0; i < 64; ++i) {
    const float at = static_cast<float>(i) / 63;
    const auto byte = [](float value) {
      return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)));
    };
    colours.push_back({byte(1.8F * at - 0.2F), byte(1.6F * at - 0.6F), byte(0.7F * std::sin(4.5F * at)), 255});
  }
  return colours;
}

}  // namespace

Scenario stack_angio_maximum_glsl_120() {
  return {
      .sentence =
          "GLSL 1.20: GL_MAX of axis-aligned slices in angio_millimetres, which gl_TextureMatrix turns into "
          "texture "
          "coordinates; window and level through a table of 64 colours change every fifth frame.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {5, 10, 15, 20, 25},
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram mip(canvas, R"(#version 120
varying vec3 vTex;
void main() {
  vTex = vec3(gl_TextureMatrix[0] * gl_Vertex);
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)",
                              R"(#version 120
uniform sampler3D texVolume;
uniform sampler1D texLut;
uniform float winCenter, winWidth;
varying vec3 vTex;
float windowed(in float v) {
  return clamp((v - winCenter) / winWidth + 0.5, 0.0, 1.0);
}
void main(void) {
  gl_FragColor = texture1D(texLut, windowed(texture3D(texVolume, vTex).r));
}
)");
        upload_volume(canvas, 0, sampled(40, 50, 32, vessels),
                      {.texel = Texel::unsigned16, .shown = Shown::luminance});
        upload_table_1d(canvas, 1, hot_metal());
        return [&canvas, mip](int frame) {
          const Gl& gl = canvas.gl;
          const Camera camera = old_camera(
              canvas, frame,
              {.azimuth = 15, .elevation = 12, .degrees_each_frame = 3, .projection = Projection::parallel});
          canvas.begin(0, 0, 0);
          constexpr float scale = 1.0F / 150;
          Matrix placed = identity, texture = identity;
          for (std::size_t i = 0; i < 3; ++i) {
            placed[5 * i] = scale;
            placed[12 + i] = 0.5F;
            texture[5 * i] = 1 / angio_millimetres[i];
            texture[12 + i] = 0.5F;
          }
          gl.MatrixMode(GL_PROJECTION);
          gl.LoadMatrixf(camera.projection.data());
          gl.ActiveTexture(GL_TEXTURE0);
          gl.MatrixMode(GL_TEXTURE);
          gl.LoadMatrixf(texture.data());
          gl.MatrixMode(GL_MODELVIEW);
          gl.LoadMatrixf((camera.view * placed).data());
          mip.use();
          mip.set("texVolume", 0);
          mip.set("texLut", 1);
          constexpr float levels[] = {0.4F, 0.55F, 0.25F}, widths[] = {0.8F, 0.5F, 0.35F, 1.1F};
          mip.set("winCenter", levels[frame / 5 % 3]);
          mip.set("winWidth", widths[frame / 5 % 4]);
          gl.Enable(GL_BLEND);
          gl.BlendEquation(GL_MAX);
          gl.BlendFunc(GL_ONE, GL_ONE);
          for (const Polygon& polygon : axis_aligned_slices(camera, 56)) {
            gl.Begin(GL_TRIANGLE_FAN);
            for (const Vector corner : polygon)
              gl.Vertex3f((corner.x - 0.5F) * angio_millimetres[0], (corner.y - 0.5F) * angio_millimetres[1],
                          (corner.z - 0.5F) * angio_millimetres[2]);
            gl.End();
          }
          gl.BlendEquation(GL_FUNC_ADD);
        };
      }};
}

}  // namespace adversary::slices
