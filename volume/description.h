// SPDX-License-Identifier: Apache-2.0
// What is known of a volume before its texels: size, type, and which of them travel.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "volume/rgba.h"
#include "volume/texel_box.h"
#include "volume/texel_type.h"
#include "volume/texture_filter.h"
#include "volume/volume_id.h"

namespace understudy::volume {

/// Each axis of `size` has 1 to max_axis_texels texels (volume/cell_lattice.h).
struct VolumeDescription {
  VolumeId id = 0;
  std::uint64_t version = 0;  ///< grows whenever the texels change
  std::array<int, 3> size{};  ///< of the whole texture, in texels
  TexelType type = TexelType::u8;
  std::array<Wrap, 3> wrap{};
  Rgba border{};  ///< the texture's border colour; scalar fields use the first component
  /// The texels that travel: the part of the texture that the application shows, with one texel around it for
  /// the filter. What lies outside (power-of-two padding) is never sent and never sampled.
  TexelBox stored;
  /// So many cells around its own each node holds beside them: for the second samples of segments and segments,
  /// and for gradients (see ghost_layer_needed()).
  int ghost_layer = 0;
  /// The cells that are shown, of the lattice (volume/cell_lattice.h); without it all. Images of parts that
  /// tile the lattice compose to that of the whole, as those of ranks do.
  std::optional<TexelBox> part;

  bool operator==(const VolumeDescription&) const = default;
};

}  // namespace understudy::volume
