// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/views/shown_windows.h"

#include <algorithm>

namespace understudy::spu {
namespace {

constexpr std::size_t most_windows = 64;

}  // namespace

const ShownWindows::Window* ShownWindows::find(std::uintptr_t window) const {
  const auto found = std::ranges::find(windows_, window, &Window::window);
  return found == windows_.end() ? nullptr : &*found;
}

ShownWindows::Window* ShownWindows::find(std::uintptr_t window) {
  const auto found = std::ranges::find(windows_, window, &Window::window);
  return found == windows_.end() ? nullptr : &*found;
}

ShownWindows::Window& ShownWindows::of(std::uintptr_t window) {
  const auto found = std::ranges::find(windows_, window, &Window::window);
  if (found != windows_.end()) {
    std::rotate(found, found + 1, windows_.end());
  } else {
    if (windows_.size() == most_windows) windows_.erase(windows_.begin());
    windows_.push_back({.window = window});
  }
  return windows_.back();
}

std::uint64_t ShownWindows::frame(std::uintptr_t window) const {
  const std::scoped_lock lock(mutex_);
  const Window* const known = find(window);
  return known == nullptr ? 0 : known->frame;
}

bool ShownWindows::can_be_redrawn(std::uintptr_t window) const {
  const std::scoped_lock lock(mutex_);
  const Window* const known = find(window);
  return known != nullptr && known->can_be_redrawn;
}

void ShownWindows::shown(const View& view, bool late) {
  const std::scoped_lock lock(mutex_);
  Window* const known = find(view.window);
  if (known == nullptr) return;
  std::erase_if(known->late, [&](const LateView& each) { return each.view == view; });
  if (late) known->late.push_back({view, known->frame});
}

LateViews ShownWindows::frame_ended(std::uintptr_t window, bool can_be_redrawn) {
  if (window == 0) return LateViews::none;
  const std::scoped_lock lock(mutex_);
  Window& shown = of(window);
  const std::uint64_t ended = shown.frame;
  // A window that is not known begins with a number that follows no other window's.
  shown.frame = ended == 0 ? last_frame_ + 2 : ended + 1;
  last_frame_ = std::max(last_frame_, shown.frame);
  shown.can_be_redrawn = can_be_redrawn;
  std::erase_if(shown.late, [](LateView& late) {
    return late.frames_after_asking >= 0 && ++late.frames_after_asking == 2;
  });
  if (shown.late.empty()) return LateViews::none;
  const bool all_of_this_frame =
      std::ranges::all_of(shown.late, [&](const LateView& late) { return late.frame == ended; });
  return all_of_this_frame ? LateViews::of_this_frame : LateViews::of_earlier_frames;
}

void ShownWindows::asked(std::uintptr_t window) {
  const std::scoped_lock lock(mutex_);
  Window* const known = find(window);
  if (known == nullptr) return;
  for (LateView& late : known->late) late.frames_after_asking = std::max(late.frames_after_asking, 0);
}

}  // namespace understudy::spu
