// SPDX-License-Identifier: Apache-2.0
// While all ranks draw, ranks nearer to the eye tell those behind them which tiles of the image are already
// opaque: what lies behind these is neither drawn nor sent. No rank waits for a control message while it draws,
// so a late one saves less. What has been drawn in vain is cleared before images are exchanged, so the image
// does not depend on when control messages arrive.
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
  /// For one image: the `number`-th, by the same count on all ranks. `order` holds all ranks, front first, and
  /// `footprints`, by rank, what each could show at most; both are the same on all ranks. Made on the thread
  /// that uses `communicator`.
  OpaqueTiles(Communicator& communicator, std::uint32_t number, const volume::RenderRequest& request,
              std::span<const Rank> order, std::span<const volume::Rect> footprints);

  bool hides(const volume::Rect& pixels) override;
  void cover(const volume::Rect& pixels) override;
  bool from_the_end() const override { return nearer_.size() % 2 == 1; }

  /// To be called when this rank has drawn: sends the tiles that it has not sent yet. Returns how many control
  /// messages each rank behind this one was sent.
  std::uint32_t tell_rest();
  /// All control messages that this rank has sent.
  std::uint64_t messages() const { return std::uint64_t(control_told_) * farther_.size(); }
  std::uint64_t bytes() const { return bytes_told_ * farther_.size(); }
  /// To be called when all ranks have drawn, with what their tell_rest() returned: clears hidden pixels.
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
  volume::Rect tiles_;  ///< of the window, in units of tiles
  std::vector<Rank> nearer_, farther_;
  Tiles hidden_;
  std::mutex mutex_;
  std::vector<std::uint32_t> covered_;  ///< tiles that other ranks have not been told of
  std::uint32_t control_told_ = 0;
  std::uint64_t bytes_told_ = 0;              ///< to each rank behind
  std::vector<std::uint32_t> control_heard_;  ///< by rank
};

}  // namespace understudy::compositor
