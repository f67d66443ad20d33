// SPDX-License-Identifier: Apache-2.0
// Draws a volume of which not all bricks are in textures. A ray walks as far as it meets no visible brick that
// is absent; there it waits, with what it has composed, for the next pass, which brings in the bricks from the
// first on that a ray waits for, in visibility order. So every ray takes the samples that it would take of the
// whole volume, in their order, and bricks that no ray reaches are never brought in.
#pragma once

#include <array>
#include <vector>

#include "volume/glsl/brick_atlas.h"
#include "volume/glsl/march_shader.h"
#include "volume/image.h"

namespace understudy::volume::glsl {

class BrickPasses {
 public:
  BrickPasses(Device& device, const BrickStore& store, int brick_cells);
  BrickPasses(const BrickPasses&) = delete;
  BrickPasses& operator=(const BrickPasses&) = delete;
  ~BrickPasses();

  BrickAtlas& atlas() { return atlas_; }
  const BrickAtlas& atlas() const { return atlas_; }

  /// Draws rays that are bound already, with the program in use, whose uniforms are set, into `width` x
  /// `height` pixels. `order` are the bricks that show something, in visibility order. Throws NotSupported.
  void draw(const MarchProgram& program, int width, int height, std::vector<std::size_t> order);

  /// Of the last draw(): per pixel premultiplied RGBA, rows bottom up, into rows of `row_pixels`.
  void read_image(int row_pixels, float* to) const;
  /// Of the last draw(), per pixel: the next sample, samples taken (negative when the ray became opaque), 0, 0.
  const std::vector<std::array<float, 4>>& progress() const { return progress_; }
  /// Passes of the last draw().
  int passes() const { return passes_; }

 private:
  /// What rays are between two passes.
  struct State {
    explicit State(const Functions& gl) : sums(gl), progress(gl) {}
    Texture sums, progress;
    GLuint framebuffer = 0;
  };

  void resize(int width, int height);
  /// The first in `order` that a ray waits for, its size when none waits. Bricks that are not in it are added.
  std::size_t first_wanted(std::vector<std::size_t>& order) const;

  Device& device_;
  BrickAtlas atlas_;
  std::array<State, 2> states_;  ///< read by one pass and written by the next
  int made_width_ = 0, made_height_ = 0;
  int width_ = 0, height_ = 0, passes_ = 0;
  std::vector<std::array<float, 4>> progress_;
};

}  // namespace understudy::volume::glsl
