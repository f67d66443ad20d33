// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/views/drawn_views.h"

#include <algorithm>

namespace understudy::spu {
namespace {

constexpr std::size_t most_views = 64;
/// After this many frames in which a view was drawn once, an earlier second draw no longer counts: programs
/// may draw everything twice while they start.
constexpr std::uint64_t frames_to_trust = 64;

bool is_or_follows(std::uint64_t frame, std::uint64_t earlier) {
  return frame == earlier || frame == earlier + 1;
}

}  // namespace

void DrawnViews::drawn(const View& view, std::uint64_t frame) {
  const auto known = std::ranges::find(views_, view, &Drawn::view);
  if (known == views_.end()) {
    if (views_.size() == most_views) views_.erase(views_.begin());
    views_.push_back({.view = view, .frame = frame});
    return;
  }
  if (known->frame == frame) {
    known->repeated_in = frame;
  } else {
    known->in_frame_before = known->frame + 1 == frame;
    known->frame = frame;
  }
  std::rotate(known, known + 1, views_.end());
}

void DrawnViews::drawn_somewhere(GLuint texture, std::uint64_t frame) {
  const auto known = std::ranges::find_if(
      unknown_, [&](const Unknown& each) { return each.texture == texture && each.window == window_; });
  if (known != unknown_.end()) {
    known->frame = frame;
    return;
  }
  if (unknown_.size() == most_views) unknown_.erase(unknown_.begin());
  unknown_.push_back({texture, window_, frame});
}

bool DrawnViews::stands_alone(const View& view, std::uint64_t frame) const {
  const auto known = std::ranges::find(views_, view, &Drawn::view);
  if (known == views_.end() || known->frame != frame || !known->in_frame_before) return false;
  if (known->repeated_in != 0 && frame <= known->repeated_in + frames_to_trust) return false;
  return std::ranges::none_of(unknown_, [&](const Unknown& each) {
    return each.texture == view.texture && each.window == view.window && is_or_follows(frame, each.frame);
  });
}

}  // namespace understudy::spu
