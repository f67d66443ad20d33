// SPDX-License-Identifier: Apache-2.0
// A render service whose ranks read volumes themselves: each opens the file and reads its own bricks, so no
// process handles texels that it does not show.
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
  /// Size and texel type are those of the file; all texels are stored.
  volume::VolumeDescription volume;
  std::string file;  ///< as for volume::open_volume; a path is absolute
  volume::FileHints hints;
  volume::TexelChoice texels;
};

/// One rank's figures of a volume that it loads.
struct RankLoad {
  std::uint64_t texels_done = 0;
  std::uint64_t texels_in_all = 0;  ///< its share, including what it shows beyond its own cells
  std::uint64_t bytes_read = 0;     ///< of the file
  std::uint64_t brick_bytes = 0;    ///< that it keeps
  std::uint64_t peak_bytes = 0;     ///< the most memory that the process has ever had resident
  double low = 0;                   ///< least and greatest value; low > high: there was none
  double high = -1;
  double largest_error = 0;  ///< largest difference between a value and that of its texel
  std::uint64_t not_numbers = 0;
  volume::TexelBox cells;  ///< its own, in the present division of the volume
  // Of the last image, if there was one.
  double image_ms = 0;
  double image_processor_ms = 0;    ///< of all its threads
  std::uint64_t image_samples = 0;  ///< taken

  bool done() const { return texels_done == texels_in_all; }
};

class LoadingService : public RenderService {
 public:
  /// Opens the file on every rank; a volume with the same id is replaced. Returns what each rank will read.
  /// Refuses a file that one rank cannot use, with the reason, and a volume of another size or texel type.
  virtual std::vector<RankLoad> begin_load(const LoadRequest& request) = 0;
  /// Lets every rank read on for a while; the volume is complete once all are done(). After that it only
  /// returns the figures of each rank.
  virtual std::vector<RankLoad> continue_load(volume::VolumeId id) = 0;

  /// Returns how many texels of a complete volume lie in each bin, summed over the ranks.
  virtual std::vector<std::uint64_t> histogram(volume::VolumeId id, const volume::HistogramBins& bins) = 0;
};

/// One rank in this process, on all cores.
std::unique_ptr<LoadingService> embedded_loading_service();

/// Connects to the node group behind a launcher's socket. Throws ServiceLost.
std::unique_ptr<LoadingService> remote_loading_service(const std::string& address, const Patience& patience);

}  // namespace understudy::compositor
