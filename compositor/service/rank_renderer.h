// SPDX-License-Identifier: Apache-2.0
// What one rank keeps of its clients' volumes, and what it draws of them: the bricks of its own box of each
// volume's kd-tree. Groups of ranks hold a copy of a volume each (sort/sort.h); of sort-last there is one
// group. The embedded service is the only rank of one.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compositor/service/client_limits.h"
#include "compositor/sort/sort.h"
#include "compositor/transport/socket.h"
#include "volume/raycast/brick_renderer.h"
#include "volume/rect.h"
#include "volume/volume_id.h"

namespace understudy::volume {
struct FrameCounts;
struct HistogramBins;
struct Image;
struct Partition;
struct RenderRequest;
struct TexelBox;
struct VolumeDescription;
}  // namespace understudy::volume

namespace understudy::compositor {

/// Volume ids belong to the application that gave them.
struct IntegralPart;

struct VolumeKey {
  std::uint64_t client = 0;
  volume::VolumeId volume = 0;

  auto operator<=>(const VolumeKey&) const = default;  // NOLINT(modernize-use-nullptr): there is no pointer
};

/// All functions that take a volume throw RequestRefused when it is unknown or what is asked of it makes no
/// sense; what had been there before is then as it was.
class RankRenderer {
 public:
  /// Rank `rank` of `ranks`, whose bricks are drawn by what `make_renderer` makes, within `limits`.
  RankRenderer(int rank, int ranks, volume::BrickRendererFactory make_renderer = volume::cpu_renderer,
               const ClientLimits& limits = client_limits(1, {}));
  /// The same, with ranks that stand as `sort` says, on these machines, by rank.
  RankRenderer(int rank, std::vector<int> machines, volume::BrickRendererFactory make_renderer,
               const ClientLimits& limits, const SortSettings& sort);
  ~RankRenderer();

  void begin(std::uint64_t client, const volume::VolumeDescription& description);
  void begin_change(VolumeKey key, std::uint64_t version);
  /// Refuses texels that no rank may take: all ranks, asked the same, answer the same.
  void check_texels(VolumeKey key, std::span<const volume::TexelBox> boxes, std::size_t bytes) const;
  /// What of these boxes `rank` keeps; the others' texels need not come there.
  std::vector<volume::TexelBox> shares(VolumeKey key, std::span<const volume::TexelBox> boxes, int rank) const;
  /// Texels of this rank's share, one box after the other.
  void add_texels(VolumeKey key, std::span<const volume::TexelBox> shares, std::span<const std::byte> texels);
  /// Texels of these boxes change, whoever keeps them.
  void texels_change(VolumeKey key, std::span<const volume::TexelBox> boxes);
  std::size_t bytes_per_texel(VolumeKey key) const;
  const volume::VolumeDescription& description(VolumeKey key) const;
  /// What the bricks of this rank take.
  std::size_t bytes(VolumeKey key) const;
  /// This rank's own cells.
  const volume::TexelBox& cells(VolumeKey key) const;
  const Arrangement& arrangement(VolumeKey key) const;
  /// The descriptor, of this process, of bricks that this rank keeps for others; -1: it does not.
  int shared_descriptor(VolumeKey key) const;
  /// Where another rank keeps the bricks that this one shows: a path to its descriptor. They are read once the
  /// volume is complete.
  void find_bricks_at(VolumeKey key, const std::string& path);
  /// How many texels of a complete volume, those of this rank's own cells, each bin has; none in all groups but
  /// the first.
  std::vector<std::uint64_t> histogram(VolumeKey key, const volume::HistogramBins& bins) const;
  void end(VolumeKey key);
  void forget(VolumeKey key);
  void forget_client(std::uint64_t client);
  std::size_t volumes() const { return volumes_.size(); }

  /// What render() draws from now on is one image: its limit of time begins.
  void begin_image();

  /// This rank's image, cropped to what shows, of the pixels in `part` alone where one is given; adds to
  /// `counts`, time included. Of what `occlusion` hides, nothing need be there.
  volume::Image render(std::uint64_t client, const volume::RenderRequest& request, volume::FrameCounts& counts,
                       volume::Occlusion* occlusion = nullptr,
                       const std::optional<volume::Rect>& part = std::nullopt);
  /// The estimated cost of each of `tiles` for this rank, in a unit that all ranks with the same renderer
  /// share.
  std::vector<float> estimated_costs(std::uint64_t client, const volume::RenderRequest& request,
                                     std::span<const volume::Rect> tiles);
  /// By rank: outside it a rank's image is clear whatever its texels.
  std::vector<volume::Rect> footprints(std::uint64_t client, const volume::RenderRequest& request) const;
  /// This rank's parts of pixels' integrals, of as many pixels as time allows (see RenderService::integrals());
  /// of a pixel, one group tells something.
  std::vector<IntegralPart> integrals(std::uint64_t client, const volume::RenderRequest& request,
                                      std::span<const volume::Pixel> pixels, double most_ms) const;
  /// How the members of a group divide a complete volume, and what this rank holds of it. Both refuse what
  /// render() would.
  const volume::Partition& partition(std::uint64_t client, const volume::RenderRequest& request) const;
  const volume::BrickStore& bricks(std::uint64_t client, const volume::RenderRequest& request) const;
  /// Divides a complete volume, of which there is one copy, otherwise. Blocks that this rank comes to hold are
  /// asked of `packed_block`, as BrickStore::reshape() does.
  void divide(VolumeKey key, const volume::Partition& partition,
              const std::function<std::vector<std::byte>(const std::array<int, 3>& place)>& packed_block);
  /// All ranks, front first.
  std::vector<int> visibility_order(std::uint64_t client, const volume::RenderRequest& request) const;

 private:
  struct Volume;

  int ranks() const { return int(machines_.size()); }
  Arrangement arranged(const volume::VolumeDescription& description) const;
  void keep_limits(VolumeKey key, const volume::VolumeDescription& description) const;
  void keep_image_limits(const volume::RenderRequest& request) const;
  /// Of the image that is begun. Throws RequestRefused where that is over its limit.
  void within_time(Volume& volume, const std::function<void()>& work);
  Volume& find(VolumeKey key) const;
  Volume& find_complete(std::uint64_t client, const volume::RenderRequest& request) const;

  int rank_;
  std::vector<int> machines_;  // by rank
  volume::BrickRendererFactory make_renderer_;
  ClientLimits limits_;
  SortSettings sort_;
  std::optional<Deadline> image_until_;
  std::map<VolumeKey, std::unique_ptr<Volume>> volumes_;
};

}  // namespace understudy::compositor
