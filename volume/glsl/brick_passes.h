// SPDX-License-Identifier: Apache-2.0
// Draws a volume of which not all bricks are resident in textures. A ray advances until it reaches a visible
// brick that is not resident; there it waits, with its composite so far, for the next pass. That pass makes
// bricks resident in visibility order, from the first one that a ray waits for. So every ray takes the same
// samples as in the whole volume, in the same order, and bricks that no ray reaches are never uploaded.
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

  /// Draws into `width` x `height` pixels. Rays must be bound, and the program in use with its uniforms set.
  /// `order` lists the bricks that show something, in visibility order. Throws NotSupported.
  void draw(const MarchProgram& program, int width, int height, std::vector<std::size_t> order);

  /// Reads the image of the last draw(): premultiplied RGBA, rows bottom up, into rows of `row_pixels` pixels.
  void read_image(int row_pixels, float* to) const;
  /// Per pixel of the last draw(): next sample, samples taken (negative: became opaque), 0, samples hidden.
  const std::vector<std::array<float, 4>>& progress() const { return progress_; }
  /// Number of passes of the last draw().
  int passes() const { return passes_; }

 private:
  /// The state of the rays between two passes.
  struct State {
    explicit State(const Functions& gl) : sums(gl), progress(gl) {}
    Texture sums, progress;
    GLuint framebuffer = 0;
  };

  void resize(int width, int height);
  /// The first in `order` that a ray waits for, or its size if none waits. Appends missing awaited bricks.
  std::size_t first_wanted(std::vector<std::size_t>& order) const;

  Device& device_;
  BrickAtlas atlas_;
  std::array<State, 2> states_;  ///< read by one pass and written by the next
  int made_width_ = 0, made_height_ = 0;
  int width_ = 0, height_ = 0, passes_ = 0;
  std::vector<std::array<float, 4>> progress_;
};

}  // namespace understudy::volume::glsl
