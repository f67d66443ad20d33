// SPDX-License-Identifier: Apache-2.0
// Restricts drawing into a window to the rows of a tile by the scissor test, unnoticed by the application: the
// test is set before a draw and restored after it.
//
// Pixels outside the tile are never used, so a draw that cannot be restricted is drawn whole.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

/// Rows of a window, counted from the bottom as in OpenGL.
struct Rows {
  int first = 0;
  int count = 0;
  bool operator==(const Rows&) const = default;
};

/// The rows of tile `part` of `parts`: the tiles cover all rows, and their heights differ by at most one row.
Rows rows_of_tile(int height, int part, int parts);

class TileScissor {
 public:
  /// The flag, which contexts that may share lists share, records whether a list changes the scissor test.
  explicit TileScissor(std::atomic<bool>& lists_touch_scissor) : lists_touch_scissor_(lists_touch_scissor) {}

  /// Must be called when the window's size changes and when a context becomes current. 0 rows: draws nothing.
  void set(int width, Rows rows);
  /// Must be called before each call: tracks changes of the scissor test and of the framebuffer for drawing.
  void note(CallId call, const std::uint64_t* words);
  /// Whether a display list is being compiled: changes of the scissor test would be compiled into it.
  bool compiling() const { return compiling_; }
  /// Whether viewports have scissor boxes of their own.
  bool indexed() const { return indexed_; }

  /// Must be called before a draw. Returns false if it is drawn whole, as into framebuffer objects. `lists`:
  /// the call executes display lists.
  bool begin(const DispatchTable& gl, bool lists);
  /// Must be called after a draw for which begin() returned true.
  void end(const DispatchTable& gl) const;
  /// Must be called after display lists, which may have changed any state.
  void forget() { known_ = false; }

 private:
  using Box = std::array<GLint, 4>;

  void note_compiled(CallId call, const std::uint64_t* words);

  std::atomic<bool>& lists_touch_scissor_;
  int width_ = 0;
  Rows rows_;
  bool known_ = false;  ///< the following members match the application's state
  bool window_ = false;
  bool enabled_ = false;
  Box box_{};
  bool compiling_ = false;
  int pushed_in_list_ = 0;
  bool indexed_ = false;  ///< scissor boxes were set per viewport
};

}  // namespace understudy::spu
