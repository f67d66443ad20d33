// A volume that the application has cut into textures, and draws brick by brick: the cube of slices of
// drawing.h in pieces.
#pragma once

#include <functional>
#include <set>
#include <vector>

#include "gl_application.h"

namespace understudy::spu::testing {

class BrickedCube {
 public:
  /// Bricks of `edge` texels along each axis, one of which neighbours share; the last of each row is smaller.
  BrickedCube(GlApplication& app, int edge);

  std::size_t bricks() const { return bricks_.size(); }
  /// The application's name of the texture of a brick.
  GLuint texture(std::size_t brick) const { return bricks_[brick].texture; }
  /// Other colours for texels that this brick shares with none.
  void repaint(GlApplication& app, std::size_t brick) const;

  struct Drawing {
    double angle = 15;
    std::set<std::size_t> without{};                          ///< bricks that are not drawn
    std::function<void(std::size_t)> before_brick = nullptr;  ///< the how many-th to be drawn
    bool front_first = false;                                 ///< in the wrong order
    bool blending_stays = false;                              ///< switched on once, not around every brick
  };
  /// Back to front under SRC_ALPHA, 1 - SRC_ALPHA. Depth state is the caller's.
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

  std::array<int, 3> size_{};
  std::vector<Brick> bricks_;
};

}  // namespace understudy::spu::testing
