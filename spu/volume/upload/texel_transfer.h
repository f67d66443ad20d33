// SPDX-License-Identifier: Apache-2.0
// Sends the texels of a texture to the render service: all of them once, and then only those that differ.
#pragma once

#include <cstdint>
#include <span>

#include "spu/volume/texture/texels.h"
#include "spu/volume/upload/block_hashes.h"
#include "volume/description.h"

namespace understudy::compositor {
class RenderService;
}

namespace understudy::spu {

/// Bytes of texels.
struct Transferred {
  std::uint64_t sent = 0;
  std::uint64_t left_out = 0;  ///< of the whole volume, because the service already has them
};

/// Sends all of `volume.stored`; `hashes` must be new.
Transferred send_volume(compositor::RenderService& service, const volume::VolumeDescription& volume,
                        TexelSource& source, BlockHashes& hashes);

/// Reads `regions` again, and sends what differs there from `hashes`. If something does, the version of
/// `volume` increases; otherwise the service is not called.
Transferred send_changes(compositor::RenderService& service, volume::VolumeDescription& volume,
                         std::span<const volume::TexelBox> regions, TexelSource& source, BlockHashes& hashes);

}  // namespace understudy::spu
