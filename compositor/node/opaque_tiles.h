// SPDX-License-Identifier: Apache-2.0
// Ranks nearer to the eye tell those behind them, while all of them draw, which tiles of the image are
// already opaque: what lies there behind them is neither drawn nor sent. Nobody waits for a control message
// while drawing, so one that comes late saves less; but what has been drawn in vain is cleared before images
// are exchanged, so that the image does not depend on when control messages came.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "compositor/exchange/communicator.h"
#include "volume/image.h"
#include "volume/occlusion.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::compositor {

class OpaqueTiles final : public volume::Occlusion {
 public:
  /// Of one image: the `number`-th, by the same count on all ranks. `order` holds all ranks, front first, and
  /// `footprints`, by rank, what each could show at most; both are the same on all ranks. Made on the thread
  /// that `communicator` belongs to.
  OpaqueTiles(Communicator& communicator, std::uint32_t number, const volume::RenderRequest& request,
              std::span<const Rank> order, std::span<const volume::Rect> footprints);

  bool hides(const volume::Rect& pixels) override;
  void cover(const volume::Rect& pixels) override;
  bool from_the_end() const override { return nearer_.size() % 2 == 1; }

  /// When this rank has drawn: tells what it has not told yet. Returns how many control messages each rank
  /// behind it got.
  std::uint32_t tell_rest();
  /// Of all control messages that this rank has sent.
  std::uint64_t messages() const { return std::uint64_t(control_told_) * farther_.size(); }
  std::uint64_t bytes() const { return bytes_told_ * farther_.size(); }
  /// When all ranks have, with what their tell_rest() returned: clears the pixels of `image` that are hidden.
  void clear_hidden(volume::Image& image, std::span<const std::uint32_t> control_messages_of_ranks);

 private:
  using Tiles = std::vector<std::atomic<std::uint8_t>>;

  std::size_t index_of(int column, int row) const {
    return std::size_t(row - tiles_.y) * std::size_t(tiles_.width) + std::size_t(column - tiles_.x);
  }
  void tell(std::size_t least);
  void hear(const ControlMessage& control);

  Communicator& communicator_;
  std::thread::id thread_ = std::this_thread::get_id();
  std::uint32_t number_;
  volume::Rect window_;
  volume::Rect tiles_;  ///< of the window
  std::vector<Rank> nearer_, farther_;
  Tiles hidden_;
  std::mutex mutex_;
  std::vector<std::uint32_t> covered_;  ///< tiles that are not told of yet
  std::uint32_t control_told_ = 0;
  std::uint64_t bytes_told_ = 0;              ///< to every rank behind
  std::vector<std::uint32_t> control_heard_;  ///< by rank
};

}  // namespace understudy::compositor
