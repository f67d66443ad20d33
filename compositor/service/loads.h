// SPDX-License-Identifier: Apache-2.0
// The volumes that one rank reads from files: its own box of each, in parts, so that a rank can report its
// progress in between.
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
  /// How much of a file is read at a time.
  static constexpr std::size_t part_bytes = std::size_t(16) << 20;
  /// How much of a compressed file, before the rank's share, one call decompresses: a fraction of a second.
  static constexpr std::uint64_t passed_bytes = std::uint64_t(64) << 20;

  /// Passes texels to `renderer`, as its rank `rank`. Reads from `files` only.
  Loads(RankRenderer& renderer, int rank, volume::ReadableFiles files = {})
      : renderer_(renderer), rank_(rank), files_(std::move(files)) {}

  bool knows(VolumeKey key) const { return loads_.contains(key); }
  /// Begins the volume and opens its file. Throws RequestRefused and volume::FileError.
  void begin(VolumeKey key, const LoadRequest& request);
  /// Reads the next part. Throws the same; what was read before is useless then.
  void read_on(VolumeKey key);
  RankLoad figures(VolumeKey key) const;
  /// Stores what an image took this rank.
  void drew(VolumeKey key, const volume::FrameCounts& counts);
  /// To be called when all ranks are done.
  void complete(VolumeKey key);

  void forget(VolumeKey key) { loads_.erase(key); }
  void forget_client(std::uint64_t client);

 private:
  struct Load {
    std::optional<volume::TexelStream> stream;  ///< null: complete
    RankLoad figures;                           ///< except memory
  };

  RankRenderer& renderer_;
  int rank_;
  volume::ReadableFiles files_;
  volume::DicomHeaders headers_;  ///< of the folder read last, as long as there are volumes
  std::map<VolumeKey, Load> loads_;
};

}  // namespace understudy::compositor
