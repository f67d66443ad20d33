// SPDX-License-Identifier: Apache-2.0
// Into how many parts a volume must be divided so that ranks can show it one part after the other within a
// limit of memory.
#pragma once

#include <cstdint>
#include <optional>

#include "volume/partition.h"

namespace understudy::volume {
class VolumeFile;
struct VolumeDescription;
}  // namespace understudy::volume

namespace understudy::compositor {

/// Most parts that a volume is shown in.
constexpr int max_passes = 4096;

/// What `ranks` that divide the volume's shown cells take of memory at most, each, while they load and show it:
/// its bricks, and what reading a few slices of the file takes.
std::uint64_t bytes_of_rank(const volume::VolumeDescription& volume, const volume::VolumeFile& file, int ranks);

/// The fewest parts of which no rank takes more than `bytes`, but for an eighth of them. None: not even
/// max_passes are enough. Throws std::invalid_argument as volume::by_blocks() does.
std::optional<volume::Partition> passes_within(const volume::VolumeDescription& volume,
                                               const volume::VolumeFile& file, int ranks, std::uint64_t bytes);

}  // namespace understudy::compositor
