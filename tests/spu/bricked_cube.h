// SPDX-License-Identifier: Apache-2.0
// A volume that the application has cut into textures, and draws brick by brick: the cube of slices of
// drawing.h in pieces.
#pragma once

#include <array>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "gl_application.h"

namespace understudy::spu::testing {

/// How the application keeps its bricks, colours them and lays them over each other.
struct BrickKind {
  std::string name = "Colours";
  GLenum internal_format = GL_RGBA8;
  /// Of a sample, as GLSL over `texel` and its first component `s`; null: fixed function, colours are the
  /// texels.
  const char* colour = nullptr;
  std::function<void(const DispatchTable&)> blending = [](const DispatchTable& gl) {
    gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  };
  bool front_to_back = false;
  std::array<float, 4> background{0.1F, 0.2F, 0.3F, 0};
  double least_psnr = 55;  ///< of an image that is right, against the driver's own
};

class BrickedCube {
 public:
  /// Bricks of `edge` texels along each axis, one of which neighbours share; the last of each row is smaller.
  BrickedCube(GlApplication& app, int edge, BrickKind kind = {});

  std::size_t bricks() const { return bricks_.size(); }
  /// The application's name of the texture of a brick.
  GLuint texture(std::size_t brick) const { return bricks_[brick].texture; }
  /// Other colours for texels that this brick shares with none.
  void repaint(GlApplication& app, std::size_t brick) const;

  struct Drawing {
    double angle = 15;
    std::set<std::size_t> without{};                          ///< bricks that are not drawn
    std::function<void(std::size_t)> before_brick = nullptr;  ///< the how many-th to be drawn
    bool wrong_order = false;                                 ///< near and far exchanged
    bool blending_stays = false;                              ///< switched on once, not around every brick
  };
  /// Depth state is the caller's.
  void draw(GlApplication& app, const Drawing& drawing) const;
  void draw(GlApplication& app, double angle) const;

 private:
  struct Interval {
    int first, texels;
    double low, high;  ///< of the volume, [0,1]
  };
  struct Brick {
    std::array<Interval, 3> along;
    GLuint texture;
  };
  static std::vector<Interval> cut(int size, int edge);
  void draw(GlApplication& app, const Brick& brick) const;

  BrickKind kind_;
  GLuint program_ = 0;
  std::array<int, 3> size_{};
  std::vector<Brick> bricks_;
};

}  // namespace understudy::spu::testing
