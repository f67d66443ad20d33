// SPDX-License-Identifier: Apache-2.0
// The volumes that one rank reads from files: its own box of each, a part at a time, so that a rank that loads
// can be asked in between how far it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "compositor/service/loading_service.h"
#include "compositor/service/rank_renderer.h"
#include "volume/file/readable_files.h"
#include "volume/file/slices/dicom_headers.h"
#include "volume/file/texel_stream.h"
#include "volume/frame_counts.h"

namespace understudy::compositor {

class Loads {
 public:
  /// So much of a file is read in one go.
  static constexpr std::size_t part_bytes = std::size_t(16) << 20;
  /// Of a compressed file, what one call decompresses before its share: a fraction of a second.
  static constexpr std::uint64_t passed_bytes = std::uint64_t(64) << 20;

  /// Texels go to `renderer`, as rank `rank` of it, from `files` alone.
  Loads(RankRenderer& renderer, int rank, volume::ReadableFiles files = {})
      : renderer_(renderer), rank_(rank), files_(std::move(files)) {}

  bool knows(VolumeKey key) const { return loads_.contains(key); }
  /// Begins the volume, and opens its file. Throws RequestRefused and volume::FileError.
  void begin(VolumeKey key, const LoadRequest& request);
  /// Throws the same; what had been read is then of no use.
  void read_on(VolumeKey key);
  RankLoad figures(VolumeKey key) const;
  /// An image took this rank so much.
  void drew(VolumeKey key, const volume::FrameCounts& counts);
  /// Once all ranks are done.
  void complete(VolumeKey key);

  void forget(VolumeKey key) { loads_.erase(key); }
  void forget_client(std::uint64_t client);

 private:
  struct Load {
    std::optional<volume::TexelStream> stream;  ///< none: complete
    RankLoad figures;                           ///< but for memory
  };

  RankRenderer& renderer_;
  int rank_;
  volume::ReadableFiles files_;
  volume::DicomHeaders headers_;  ///< of the folder that was read last, while there are volumes
  std::map<VolumeKey, Load> loads_;
};

}  // namespace understudy::compositor
