// SPDX-License-Identifier: Apache-2.0
// Whether an application has drawn into its window's front buffer, which shows what is in it without a swap. It
// follows from the calls alone (glDrawBuffer, framebuffer objects, attributes that are pushed, display lists),
// so applications that draw into the back buffer are neither asked nor slowed.
//
// Lists that glCallLists names are taken to draw and to choose no buffer.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/table.h"
#include "spu/track/share_group.h"

namespace understudy::spu {

class FrontBuffer {
 public:
  /// `lists` must outlive it.
  FrontBuffer(bool doubly_buffered, ShareGroup& lists);

  /// A call that is about to be made.
  void note(CallId call, const std::uint64_t* words);
  /// Something was drawn into it since shown().
  bool is_drawn() const { return calls_.record.draws_front; }
  void shown() { calls_.record.draws_front = false; }
  /// Whether the call ends drawing into it: what stands for a window may have one buffer, and what is drawn
  /// into the back afterwards must not be shown.
  bool is_left_by(CallId call, const std::uint64_t* words) const;

 private:
  /// The application's calls since the context was made, or those that a list holds.
  struct Calls {
    ListRecord record;  ///< where it says `draws`, the buffer was chosen before
    std::vector<std::pair<GLbitfield, ChosenBuffer>> pushed;
  };

  void draw(Calls& calls) const;
  void choose(Calls& calls, ChosenBuffer buffer) const;
  void call_list(Calls& calls, GLuint list) const;
  void follow(CallId call, const std::uint64_t* words, Calls& calls) const;
  void bind(GLenum target, GLuint framebuffer);
  bool window_is_bound() const { return framebuffer_ == 0; }
  ChosenBuffer buffer_of(GLenum name) const;
  /// By a call that names what is drawn into; `as_before` by any other.
  ChosenBuffer chosen_by(CallId call, const std::uint64_t* words) const;

  bool doubly_buffered_;
  ShareGroup* lists_;
  GLuint framebuffer_ = 0;  ///< that is drawn into
  Calls calls_;
  Calls open_list_;
  GLuint open_ = 0;        ///< its name; 0: none
  bool executes_ = false;  ///< while it is compiled
};

}  // namespace understudy::spu
