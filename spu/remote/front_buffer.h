// SPDX-License-Identifier: Apache-2.0
// Detects whether an application has drawn into its window's front buffer, whose contents are visible without a
// swap. This follows from the calls alone (glDrawBuffer, framebuffer objects, pushed attributes, display
// lists), so applications that draw into the back buffer cause no queries and are not slowed down.
//
// Lists called by glCallLists are assumed to draw and not to choose a buffer.
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
  /// `lists` must outlive this object.
  FrontBuffer(bool doubly_buffered, ShareGroup& lists);

  /// Records a call that is about to be made.
  void note(CallId call, const std::uint64_t* words);
  /// Whether something was drawn into the front buffer since shown().
  bool is_drawn() const { return calls_.record.draws_front; }
  void shown() { calls_.record.draws_front = false; }
  /// Whether the call ends drawing into the front buffer. On the GL server the window may have a single buffer,
  /// so what is drawn into the back buffer afterwards must not be shown.
  bool is_left_by(CallId call, const std::uint64_t* words) const;

 private:
  /// The effect of the application's calls since the context was created, or of the calls in a list.
  struct Calls {
    ListRecord record;  ///< `draws`: into a buffer that was chosen before
    std::vector<std::pair<GLbitfield, ChosenBuffer>> pushed;
  };

  void draw(Calls& calls) const;
  void choose(Calls& calls, ChosenBuffer buffer) const;
  void call_list(Calls& calls, GLuint list) const;
  void follow(CallId call, const std::uint64_t* words, Calls& calls) const;
  void bind(GLenum target, GLuint framebuffer);
  bool window_is_bound() const { return framebuffer_ == 0; }
  ChosenBuffer buffer_of(GLenum name) const;
  /// The buffer that a call chooses for drawing; `as_before` for all other calls.
  ChosenBuffer chosen_by(CallId call, const std::uint64_t* words) const;

  bool doubly_buffered_;
  ShareGroup* lists_;
  GLuint framebuffer_ = 0;  ///< bound for drawing
  Calls calls_;
  Calls open_list_;
  GLuint open_ = 0;        ///< name of the list that is being compiled; 0: none
  bool executes_ = false;  ///< that list's calls are also executed
};

}  // namespace understudy::spu
