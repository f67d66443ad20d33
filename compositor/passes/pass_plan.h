// SPDX-License-Identifier: Apache-2.0
// Computes into how many parts a volume must be divided so that ranks can show one part after the other within
// a memory limit.
#pragma once

#include <cstdint>
#include <optional>

#include "volume/partition.h"

namespace understudy::volume {
class VolumeFile;
struct VolumeDescription;
}  // namespace understudy::volume

namespace understudy::compositor {

/// The largest number of parts that a volume is shown in.
constexpr int max_passes = 4096;

/// Returns the most memory that one of `ranks` ranks, which divide the volume's shown cells, needs while it
/// loads and shows its share: its bricks, and what reading a few slices of the file takes.
std::uint64_t bytes_of_rank(const volume::VolumeDescription& volume, const volume::VolumeFile& file, int ranks);

/// Divides the volume into the fewest parts, to within an eighth, of which no rank needs more than `bytes`.
/// Null: not even max_passes parts are enough. Throws std::invalid_argument as volume::by_blocks() does.
std::optional<volume::Partition> passes_within(const volume::VolumeDescription& volume,
                                               const volume::VolumeFile& file, int ranks, std::uint64_t bytes);

}  // namespace understudy::compositor
