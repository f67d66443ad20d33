// SPDX-License-Identifier: Apache-2.0
// What one rank keeps of its clients' volumes and draws of them: the bricks of its own box of each volume's
// kd-tree. Each group of ranks holds a copy of a volume (sort/sort.h); with sort-last there is one group. The
// embedded service is a single rank.
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

struct IntegralPart;

/// A volume id is unique only within the application that chose it.
struct VolumeKey {
  std::uint64_t client = 0;
  volume::VolumeId volume = 0;

  auto operator<=>(const VolumeKey&) const = default;  // NOLINT(modernize-use-nullptr): there is no pointer
};

/// All functions that take a volume throw RequestRefused if the volume is unknown or the request makes no
/// sense; the state is then unchanged.
class RankRenderer {
 public:
  /// Rank `rank` of `ranks`. `make_renderer` makes the renderers of its bricks; `limits` apply to its clients.
  RankRenderer(int rank, int ranks, volume::BrickRendererFactory make_renderer = volume::cpu_renderer,
               const ClientLimits& limits = client_limits(1, {}));
  /// Likewise, with ranks arranged by `sort`; `machines` is by rank.
  RankRenderer(int rank, std::vector<int> machines, volume::BrickRendererFactory make_renderer,
               const ClientLimits& limits, const SortSettings& sort);
  ~RankRenderer();

  void begin(std::uint64_t client, const volume::VolumeDescription& description);
  void begin_change(VolumeKey key, std::uint64_t version);
  /// Refuses invalid texels: all ranks decide the same for the same arguments.
  void check_texels(VolumeKey key, std::span<const volume::TexelBox> boxes, std::size_t bytes) const;
  /// Returns the parts of these boxes that `rank` keeps; it needs no other texels.
  std::vector<volume::TexelBox> shares(VolumeKey key, std::span<const volume::TexelBox> boxes, int rank) const;
  /// Adds texels of this rank's share, one box after the other.
  void add_texels(VolumeKey key, std::span<const volume::TexelBox> shares, std::span<const std::byte> texels);
  /// Announces that texels of these boxes change, whichever rank keeps them.
  void texels_change(VolumeKey key, std::span<const volume::TexelBox> boxes);
  std::size_t bytes_per_texel(VolumeKey key) const;
  const volume::VolumeDescription& description(VolumeKey key) const;
  /// Returns the memory of this rank's bricks.
  std::size_t bytes(VolumeKey key) const;
  /// Returns this rank's own cells.
  const volume::TexelBox& cells(VolumeKey key) const;
  const Arrangement& arrangement(VolumeKey key) const;
  /// Returns this process's descriptor of the bricks that this rank keeps for others; -1: it keeps none.
  int shared_descriptor(VolumeKey key) const;
  /// Sets where another rank keeps the bricks that this one shows: a path to its descriptor. They are read once
  /// the volume is complete.
  void find_bricks_at(VolumeKey key, const std::string& path);
  /// Returns how many texels of a complete volume, among this rank's own cells, lie in each bin; zeros in all
  /// groups but the first.
  std::vector<std::uint64_t> histogram(VolumeKey key, const volume::HistogramBins& bins) const;
  void end(VolumeKey key);
  void forget(VolumeKey key);
  void forget_client(std::uint64_t client);
  std::size_t volumes() const { return volumes_.size(); }

  /// Begins an image and its time limit: the following calls of render() belong to it.
  void begin_image();

  /// Renders this rank's image, cropped to what shows, within `part` if that is given; adds to `counts`,
  /// including the time. Pixels that `occlusion` hides may be missing.
  volume::Image render(std::uint64_t client, const volume::RenderRequest& request, volume::FrameCounts& counts,
                       volume::Occlusion* occlusion = nullptr,
                       const std::optional<volume::Rect>& part = std::nullopt);
  /// Returns the estimated cost of each of `tiles` for this rank, in a unit that all ranks with the same
  /// renderer share.
  std::vector<float> estimated_costs(std::uint64_t client, const volume::RenderRequest& request,
                                     std::span<const volume::Rect> tiles);
  /// Returns footprints by rank: outside its footprint a rank's image is clear, whatever its texels.
  std::vector<volume::Rect> footprints(std::uint64_t client, const volume::RenderRequest& request) const;
  /// Returns this rank's parts of the integrals of as many pixels as time allows (see
  /// RenderService::integrals()). Each pixel is integrated by one group; the parts of the others are zero.
  std::vector<IntegralPart> integrals(std::uint64_t client, const volume::RenderRequest& request,
                                      std::span<const volume::Pixel> pixels, double most_ms) const;
  /// How the members of a group divide a complete volume, and this rank's bricks of it. Both refuse what
  /// render() would.
  const volume::Partition& partition(std::uint64_t client, const volume::RenderRequest& request) const;
  const volume::BrickStore& bricks(std::uint64_t client, const volume::RenderRequest& request) const;
  /// Changes the division of a complete volume of which there is one copy. Blocks that this rank receives come
  /// from `packed_block`, as in BrickStore::reshape().
  void divide(VolumeKey key, const volume::Partition& partition,
              const std::function<std::vector<std::byte>(const std::array<int, 3>& place)>& packed_block);
  /// Returns all ranks, front first.
  std::vector<int> visibility_order(std::uint64_t client, const volume::RenderRequest& request) const;

 private:
  struct Volume;

  int ranks() const { return int(machines_.size()); }
  Arrangement arranged(VolumeKey key, const volume::VolumeDescription& description) const;
  void keep_limits(VolumeKey key, const volume::VolumeDescription& description) const;
  void keep_image_limits(const volume::RenderRequest& request) const;
  /// Runs `work` for the current image. Throws RequestRefused if that exceeds the time limit.
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
