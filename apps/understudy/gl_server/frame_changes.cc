// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/gl_server/frame_changes.h"

#include <algorithm>
#include <cstring>

namespace understudy::launcher {
namespace {

void turn_over(spu::Extent2D extent, std::span<const std::uint8_t> rgba, std::vector<std::uint32_t>& to) {
  const auto width = std::size_t(extent.width);
  const auto height = std::size_t(extent.height);
  to.resize(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* from = rgba.data() + (height - 1 - y) * width * 4;
    std::uint32_t* row = to.data() + y * width;
    for (std::size_t x = 0; x < width; ++x, from += 4)
      row[x] = std::uint32_t(from[0]) << 16 | std::uint32_t(from[1]) << 8 | from[2];
  }
}

}  // namespace

spu::ImageChange FrameChanges::next(std::uint64_t drawable, spu::Extent2D extent,
                                    std::span<const std::uint8_t> rgba) {
  turn_over(extent, rgba, now_);
  Last& last = last_[drawable];
  spu::ImageChange change{.drawable = drawable, .extent = extent};
  const auto width = std::size_t(extent.width);
  const auto height = std::size_t(extent.height);
  const auto row = [&](std::vector<std::uint32_t>& pixels, std::size_t y) { return pixels.data() + y * width; };
  std::size_t top = 0;
  std::size_t bottom = height;
  std::size_t left = 0;
  std::size_t right = width;
  if (last.extent == extent) {
    const auto same = [&](std::size_t y) {
      return std::memcmp(row(now_, y), row(last.pixels, y), width * sizeof(std::uint32_t)) == 0;
    };
    while (top < bottom && same(top)) ++top;
    while (bottom > top && same(bottom - 1)) --bottom;
    left = width;
    right = 0;
    for (std::size_t y = top; y < bottom; ++y) {
      const std::uint32_t* now = row(now_, y);
      const std::uint32_t* before = row(last.pixels, y);
      left = std::size_t(std::mismatch(now, now + left, before).first - now);
      std::size_t end = width;
      while (end > right && now[end - 1] == before[end - 1]) --end;
      right = end;
    }
  }
  if (top < bottom && left < right) {
    change.x = int(left);
    change.y = int(top);
    change.width = int(right - left);
    change.height = int(bottom - top);
    changed_.clear();
    for (std::size_t y = top; y < bottom; ++y)
      changed_.insert(changed_.end(), row(now_, y) + left, row(now_, y) + right);
    change.pixels = std::as_bytes(std::span(changed_));
  }
  last.extent = extent;
  last.pixels.swap(now_);
  return change;
}

}  // namespace understudy::launcher
