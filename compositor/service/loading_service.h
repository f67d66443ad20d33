// SPDX-License-Identifier: Apache-2.0
// A render service whose ranks read volumes themselves: each opens the file and reads its own bricks, so a
// volume passes through no process that does not show it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "compositor/service.h"
#include "volume/description.h"
#include "volume/file/texel_stream.h"

namespace understudy::volume {
struct HistogramBins;
}

namespace understudy::compositor {

struct Patience;

struct LoadRequest {
  /// Size and texel type are those of the file; all of it is stored.
  volume::VolumeDescription volume;
  std::string file;  ///< as volume::open_volume takes it; a path is absolute
  volume::FileHints hints;
  volume::TexelChoice texels;
};

/// What one rank has of a volume that it loads.
struct RankLoad {
  std::uint64_t texels_done = 0;
  std::uint64_t texels_in_all = 0;  ///< its share, with what it shows beyond its own cells
  std::uint64_t bytes_read = 0;     ///< of the file
  std::uint64_t brick_bytes = 0;    ///< what it keeps
  std::uint64_t peak_bytes = 0;     ///< the most memory that the process ever had resident
  double low = 0;                   ///< least and greatest value; low > high when there was none
  double high = -1;
  double largest_error = 0;  ///< between a value and that of its texel
  std::uint64_t not_numbers = 0;
  volume::TexelBox cells;  ///< its own, as the volume is divided now
  // Of the last image, where there was one.
  double image_ms = 0;
  double image_processor_ms = 0;    ///< of all its threads
  std::uint64_t image_samples = 0;  ///< taken

  bool done() const { return texels_done == texels_in_all; }
};

class LoadingService : public RenderService {
 public:
  /// Opens the file on every rank; an id that exists is replaced. Returns what each rank is about to read. A
  /// file that one rank cannot use is refused, with the reason, and so is a volume of another size or texel
  /// type.
  virtual std::vector<RankLoad> begin_load(const LoadRequest& request) = 0;
  /// Every rank reads on for a while; the volume is complete once all are done(). From then on this only tells
  /// what each rank has.
  virtual std::vector<RankLoad> continue_load(volume::VolumeId id) = 0;

  /// How many texels of a complete volume each bin has, summed over the ranks.
  virtual std::vector<std::uint64_t> histogram(volume::VolumeId id, const volume::HistogramBins& bins) = 0;
};

/// In this process, on all cores: one rank.
std::unique_ptr<LoadingService> embedded_loading_service();

/// The node group behind a launcher's socket. Throws ServiceLost.
std::unique_ptr<LoadingService> remote_loading_service(const std::string& address, const Patience& patience);

}  // namespace understudy::compositor
