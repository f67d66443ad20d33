// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/opaque_tiles.h"

#include <algorithm>
#include <cstring>

#include "volume/request.h"

namespace understudy::compositor {

namespace {

using volume::Rect;

// A control message consists of the image's number and of the indices of tiles, row after row of the window's
// tiles.
constexpr std::size_t tiles_per_control_message = most_control_bytes / sizeof(std::uint32_t) - 1;

Rect pixels_of_tile(int column, int row) {
  return {volume::occlusion_tile * column, volume::occlusion_tile * row, volume::occlusion_tile,
          volume::occlusion_tile};
}

bool contains(const Rect& outer, const Rect& inner) {
  return intersection(outer, inner) == inner;
}

}  // namespace

OpaqueTiles::OpaqueTiles(Communicator& communicator, std::uint32_t number, const volume::RenderRequest& request,
                         std::span<const Rank> order, std::span<const Rect> footprints)
    : communicator_(communicator),
      number_(number),
      window_(intersection(request.window, request.viewport)),
      tiles_(volume::tiles_touched(window_)),
      hidden_(tiles_.pixels()),
      control_heard_(footprints.size()) {
  // Control messages go to ranks whose footprints share a tile with this rank's.
  const Rect mine = volume::tiles_touched(footprints[std::size_t(communicator.rank())]);
  std::vector<Rank>* side = &nearer_;
  for (const Rank rank : order) {
    if (rank == communicator.rank())
      side = &farther_;
    else if (!intersection(mine, volume::tiles_touched(footprints[std::size_t(rank)])).empty())
      side->push_back(rank);
  }
}

bool OpaqueTiles::hides(const Rect& pixels) {
  // Only one thread may use the communicator.
  if (std::this_thread::get_id() == thread_) {
    while (const std::optional<ControlMessage> control = communicator_.take_control_message()) hear(*control);
    constexpr std::size_t worth_a_control_message = 8;
    tell(worth_a_control_message);
  }
  if (nearer_.empty()) return false;
  const Rect touched = volume::tiles_touched(intersection(pixels, window_));
  for (int row = touched.y; row < touched.y + touched.height; ++row)
    for (int column = touched.x; column < touched.x + touched.width; ++column)
      if (hidden_[index_of(column, row)].load(std::memory_order_relaxed) == 0) return false;
  return true;
}

void OpaqueTiles::cover(const Rect& pixels) {
  if (farther_.empty()) return;
  const Rect touched = volume::tiles_touched(intersection(pixels, window_));
  for (int row = touched.y; row < touched.y + touched.height; ++row)
    for (int column = touched.x; column < touched.x + touched.width; ++column) {
      if (!contains(pixels, intersection(window_, pixels_of_tile(column, row)))) continue;
      const std::lock_guard lock(mutex_);
      covered_.push_back(std::uint32_t(index_of(column, row)));
    }
}

void OpaqueTiles::tell(std::size_t least) {
  std::vector<std::uint32_t> tiles;
  {
    const std::lock_guard lock(mutex_);
    if (covered_.size() < std::max<std::size_t>(least, 1)) return;
    tiles.swap(covered_);
  }
  for (std::size_t i = 0; i < tiles.size(); i += tiles_per_control_message) {
    std::vector<std::uint32_t> control{number_};
    const auto some = std::span(tiles).subspan(i, std::min(tiles_per_control_message, tiles.size() - i));
    control.insert(control.end(), some.begin(), some.end());
    for (const Rank rank : farther_) communicator_.send_control(rank, std::as_bytes(std::span(control)));
    ++control_told_;
    bytes_told_ += std::as_bytes(std::span(control)).size();
  }
}

void OpaqueTiles::hear(const ControlMessage& control) {
  std::vector<std::uint32_t> words(control.bytes.size() / sizeof(std::uint32_t));
  std::memcpy(words.data(), control.bytes.data(), sizeof(std::uint32_t) * words.size());
  // Control messages may be left from an image that some rank refused.
  if (words.empty() || words.front() != number_) return;
  ++control_heard_[std::size_t(control.from)];
  for (const std::uint32_t index : std::span(words).subspan(1))
    if (index < hidden_.size()) hidden_[index].store(1, std::memory_order_relaxed);
}

std::uint32_t OpaqueTiles::tell_rest() {
  tell(1);
  return control_told_;
}

void OpaqueTiles::clear_hidden(volume::Image& image, std::span<const std::uint32_t> control_messages_of_ranks) {
  const auto missing = [&](Rank rank) {
    return control_heard_[std::size_t(rank)] < control_messages_of_ranks[std::size_t(rank)];
  };
  while (std::ranges::any_of(nearer_, missing)) hear(communicator_.wait_for_control_message());
  const Rect touched = volume::tiles_touched(intersection(image.rect, window_));
  for (int row = touched.y; row < touched.y + touched.height; ++row)
    for (int column = touched.x; column < touched.x + touched.width; ++column) {
      if (hidden_[index_of(column, row)].load(std::memory_order_relaxed) == 0) continue;
      const Rect pixels = intersection(image.rect, pixels_of_tile(column, row));
      for (int y = pixels.y; y < pixels.y + pixels.height; ++y)
        std::fill_n(image.at(pixels.x, y), 4 * std::size_t(pixels.width), 0.0F);
    }
}

}  // namespace understudy::compositor
