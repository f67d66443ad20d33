// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {
namespace {

constexpr std::array<float, 3> brain_voxels{56, 64, 32};

float brain(float x, float y, float z) {
  const float u = x - 0.5F, v = y - 0.5F, w = z - 0.45F;
  const float radius = std::sqrt(u * u + 0.8F * v * v + 1.2F * w * w);
  const float folds = 0.05F * std::sin(21 * x + 6 * std::sin(13 * y)) * std::cos(17 * z + 5 * x);
  const float inside = 1 / (1 + std::exp(30 * (radius - 0.4F + folds)));
  return std::clamp(inside * (0.35F + 0.9F * std::abs(waves(x, z, y) - 0.4F) + folds), 0.0F, 1.0F);
}

}  // namespace

Scenario stack_brain_fixed_modulate() {
  return {
      .sentence =
          "Fixed function: intensities modulated by a colour, with texture coordinates in voxels that the "
          "texture "
          "matrix scales, an alpha test, opaque triangles before it and a scissor box; colour and alpha test "
          "change.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {7, 14, 21},
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        upload_volume(canvas, 0, sampled(56, 64, 32, brain), {.shown = Shown::intensity});
        return [&canvas](int frame) {
          const Gl& gl = canvas.gl;
          const Camera camera = old_camera(
              canvas, frame, {.azimuth = 200, .elevation = 30, .distance = 2.3F, .degrees_each_frame = 3});
          // A voxel is 1 x 1 x 1.6; the longest edge is 1 in the world.
          constexpr std::array<float, 3> edges{56 / 64.0F, 1, 32 * 1.6F / 64.0F};
          Matrix placed = identity, texture = identity;
          for (std::size_t i = 0; i < 3; ++i) {
            placed[5 * i] = edges[i] / brain_voxels[i];
            placed[12 + i] = 0.5F - 0.5F * edges[i];
            texture[5 * i] = 1 / brain_voxels[i];
          }
          begin_old_frame(canvas, camera);
          gl.Enable(GL_SCISSOR_TEST);
          gl.Scissor(0, canvas.height() / 6, canvas.width() - canvas.width() / 7, canvas.height());
          gl.Enable(GL_DEPTH_TEST);
          gl.DepthFunc(GL_LEQUAL);
          gl.Disable(GL_BLEND);
          gl.Disable(GL_ALPHA_TEST);
          gl.Disable(GL_TEXTURE_3D);
          gl.Begin(GL_TRIANGLES);
          gl.Color3f(0.2F, 0.7F, 0.3F);
          gl.Vertex3f(0.2F, 0.1F, 0.5F);
          gl.Vertex3f(0.95F, 0.35F, 0.6F);
          gl.Color3f(0.8F, 0.3F, 0.2F);
          gl.Vertex3f(0.45F, 0.95F, 0.35F);
          gl.End();

          gl.LoadMatrixf((camera.view * placed).data());
          gl.MatrixMode(GL_TEXTURE);
          gl.LoadMatrixf(texture.data());
          gl.MatrixMode(GL_MODELVIEW);
          gl.Enable(GL_TEXTURE_3D);
          gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
          constexpr float colours[3][4] = {{0.9F, 0.8F, 0.7F, 0.3F}, {1, 1, 1, 0.15F}, {0.5F, 0.9F, 1, 0.5F}};
          const auto& colour = colours[frame / 7 % 3];
          gl.Color4f(colour[0], colour[1], colour[2], colour[3]);
          gl.Enable(GL_ALPHA_TEST);
          gl.AlphaFunc(GL_GREATER, frame < 14 ? 0.05F : 0.1F);
          gl.DepthMask(GL_FALSE);
          gl.Enable(GL_BLEND);
          gl.BlendEquation(GL_FUNC_ADD);
          gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
          for (const Polygon& polygon : axis_aligned_slices(camera, 64)) {
            gl.Begin(GL_POLYGON);
            for (const Vector corner : polygon) {
              const float x = corner.x * brain_voxels[0], y = corner.y * brain_voxels[1],
                          z = corner.z * brain_voxels[2];
              gl.TexCoord3f(x, y, z);
              gl.Vertex3f(x, y, z);
            }
            gl.End();
          }
          gl.DepthMask(GL_TRUE);
          gl.Disable(GL_ALPHA_TEST);
          gl.Disable(GL_SCISSOR_TEST);
        };
      }};
}

}  // namespace adversary::slices
