// SPDX-License-Identifier: Apache-2.0
// Keeps the ranks of a node group equally busy: before an image all ranks decide, each for itself and all
// alike, where the planes of its volume go, and send each other the blocks that change ranks.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "compositor/balance/balancer.h"
#include "compositor/balance/block_cache.h"
#include "compositor/exchange/communicator.h"
#include "compositor/service/rank_renderer.h"
#include "volume/request.h"

namespace understudy::compositor {

/// Figures of one move of planes, on this rank.
struct MoveFigures {
  volume::VolumeId volume = 0;
  int planes = 0;
  std::size_t blocks_received = 0;
  std::size_t blocks_from_cache = 0;  ///< given away before, and still in the cache
  std::size_t bytes_received = 0;
  double ms = 0;
  /// (max - min) / mean of the ranks' times in the image before; empty: none was measured.
  std::optional<double> deviation;
};

struct BalanceSettings {
  Balance balance = Balance::off;
  /// Called on every rank after each of its moves.
  std::function<void(const MoveFigures&)> moved = [](const MoveFigures&) {};
  /// Bytes of blocks given away that each rank keeps for each volume.
  std::size_t cache_bytes = std::size_t(64) << 20;
  /// Returns the bytes that this rank may still fill; called before a volume's first image and after each move.
  std::function<std::size_t()> memory_left = [] { return std::numeric_limits<std::size_t>::max(); };
};

class Rebalancer {
 public:
  /// For volumes of which all ranks together hold one copy.
  Rebalancer(Communicator& communicator, RankRenderer& renderer, BalanceSettings settings,
             volume::PartitionMethod method = volume::PartitionMethod::blocks);

  /// Collective, before an image is rendered. Returns what `decode` returns. Throws what `decode` throws, or
  /// what is wrong with the request on this rank, once all ranks have been told; nothing has moved anywhere
  /// then. What fails later, on a rank that others wait for (memory), ends the group.
  volume::RenderRequest before_image(std::uint64_t client,
                                     const std::function<volume::RenderRequest()>& decode);
  /// Takes what all ranks did for the image.
  void after_image(VolumeKey key, std::span<const RankWork> work);

  /// To be called when texels of these boxes have changed in a complete volume.
  void texels_changed(VolumeKey key, const volume::VolumeDescription& description,
                      std::span<const volume::TexelBox> boxes);
  /// Begins a volume anew. Keeps the times measured for its predecessor's images and moves: an application may
  /// upload the whole volume for every frame.
  void begin(VolumeKey key);
  void forget(VolumeKey key) { volumes_.erase(key); }
  void forget_client(std::uint64_t client);

 private:
  /// The fields of a request that change the costs of blocks, except the camera.
  struct Appearance {
    volume::Operator op = volume::Operator::over;
    volume::Classification classification;
    std::vector<volume::Surface> surfaces;
    std::vector<volume::HalfSpace> clip_planes;
    volume::Box region;

    bool operator==(const Appearance&) const = default;
  };
  struct Volume {
    std::unique_ptr<Balancer> balancer;
    BlockCache given_away;
    std::vector<RankWork> work;
    double ms_per_block = 0;
    std::vector<std::size_t> most_blocks;  ///< by rank; empty: not known yet
    std::optional<Appearance> cut_for;     ///< what was shown when the partition was last decided
    int images_since = 0;
  };

  struct Expected;
  struct Traffic;
  static Appearance appearance(const volume::RenderRequest& request);
  bool is_due(const Volume& volume, const volume::RenderRequest& request) const;

  Volume new_volume() const;
  Volume& volume_of(VolumeKey key);
  void expect(std::uint64_t client, const std::function<volume::RenderRequest()>& decode, Expected& expected);
  void gather_costs(Expected& expected);
  MoveFigures move(VolumeKey key, Volume& volume, const volume::RenderRequest& request,
                   const volume::Partition& next);
  void send_blocks(Volume& volume, const volume::BrickStore& bricks, std::span<const volume::TexelBox> before,
                   std::span<const volume::TexelBox> after,
                   std::map<BlockPlace, std::vector<std::byte>>& received, MoveFigures& figures);
  void ask_for_blocks(Traffic& traffic, Volume& volume, std::map<BlockPlace, std::vector<std::byte>>& received,
                      MoveFigures& figures);
  void announce_blocks(Traffic& traffic, const volume::BrickStore& bricks);
  void exchange_blocks(Traffic& traffic);
  std::size_t most_blocks_here(const volume::BrickStore& bricks) const;

  Communicator& communicator_;
  RankRenderer& renderer_;
  BalanceSettings settings_;
  volume::PartitionMethod method_;
  std::map<VolumeKey, Volume> volumes_;
};

}  // namespace understudy::compositor
