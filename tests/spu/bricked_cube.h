// SPDX-License-Identifier: Apache-2.0
// A volume that the application has cut into textures and draws brick by brick: the cube of slices of drawing.h
// in pieces.
#pragma once

#include <array>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "gl_application.h"

namespace understudy::spu::testing {

/// How the application stores, colours and blends its bricks.
struct BrickKind {
  std::string name = "Colours";
  GLenum internal_format = GL_RGBA8;
  /// GLSL expression for the colour of a sample, over `texel` and its first component `s`; null: fixed
  /// function, colours are the texels.
  const char* colour = nullptr;
  std::function<void(const DispatchTable&)> blending = [](const DispatchTable& gl) {
    gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  };
  bool front_to_back = false;
  std::array<float, 4> background{0.1F, 0.2F, 0.3F, 0};
  double least_psnr = 55;  ///< PSNR of a correct image against the driver's own
};

class BrickedCube {
 public:
  /// Bricks of `edge` texels along each axis; neighbours share one texel, and the last brick of each row is
  /// smaller.
  BrickedCube(GlApplication& app, int edge, BrickKind kind = {});

  std::size_t bricks() const { return bricks_.size(); }
  /// The application's texture name of a brick.
  GLuint texture(std::size_t brick) const { return bricks_[brick].texture; }
  /// Changes the colours of texels that this brick shares with no other.
  void repaint(GlApplication& app, std::size_t brick) const;

  struct Drawing {
    double angle = 15;
    std::set<std::size_t> without{};                          ///< bricks that are not drawn
    std::function<void(std::size_t)> before_brick = nullptr;  ///< called with the index in drawing order
    bool wrong_order = false;                                 ///< swaps near and far
    bool blending_stays = false;                              ///< enabled once, not around every brick
  };
  /// Depth state is set by the caller.
  void draw(GlApplication& app, const Drawing& drawing) const;
  void draw(GlApplication& app, double angle) const;

 private:
  struct Interval {
    int first, texels;
    double low, high;  ///< in the volume, [0,1]
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
