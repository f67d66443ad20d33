// SPDX-License-Identifier: Apache-2.0
// Keeps what is drawn into a window within a tile of its rows, by the scissor test, which nobody sees changed:
// it is set before a draw and put back after it.
//
// Pixels outside the tile are nobody's concern: a draw that cannot be kept within it is drawn whole.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

/// Rows of a window, from the bottom as OpenGL counts them.
struct Rows {
  int first = 0;
  int count = 0;
  bool operator==(const Rows&) const = default;
};

/// Those of part `part` of `parts`: together they are all rows, and differ by one row at most.
Rows rows_of_tile(int height, int part, int parts);

class TileScissor {
 public:
  /// Whether a display list changes the scissor test is known to all contexts, as they may share lists.
  explicit TileScissor(std::atomic<bool>& lists_touch_scissor) : lists_touch_scissor_(lists_touch_scissor) {}

  /// The window has another size, or a context is current again. Rows of count 0: nothing is drawn into it.
  void set(int width, Rows rows);
  /// Before each call, for what changes the scissor test and what draws are drawn into.
  void note(CallId call, const std::uint64_t* words);
  /// Between glNewList and glEndList: calls are compiled, and the scissor test would be, too.
  bool compiling() const { return compiling_; }
  /// Viewports have scissor boxes of their own.
  bool indexed() const { return indexed_; }

  /// Before a draw; false when it is drawn whole, as into framebuffer objects. `lists`: it calls display lists.
  bool begin(const DispatchTable& gl, bool lists);
  /// After a draw for which begin() was true.
  void end(const DispatchTable& gl) const;
  /// After display lists, which may have changed anything.
  void forget() { known_ = false; }

 private:
  using Box = std::array<GLint, 4>;

  void note_compiled(CallId call, const std::uint64_t* words);

  std::atomic<bool>& lists_touch_scissor_;
  int width_ = 0;
  Rows rows_;
  bool known_ = false;  ///< what follows is what the application has set
  bool window_ = false;
  bool enabled_ = false;
  Box box_{};
  bool compiling_ = false;
  int pushed_in_list_ = 0;
  bool indexed_ = false;  ///< there are scissor boxes by viewport
};

}  // namespace understudy::spu
