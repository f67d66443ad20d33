// SPDX-License-Identifier: Apache-2.0
// The properties of a volume: size, type, and the range of texels that is sent to the nodes.
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
  std::uint64_t version = 0;  ///< increases whenever the texels change
  std::array<int, 3> size{};  ///< of the whole texture, in texels
  TexelType type = TexelType::u8;
  std::array<Wrap, 3> wrap{};
  Rgba border{};  ///< the texture's border colour; scalar fields use the first component
  /// The texels that are sent: the part of the texture that the application shows, plus one texel around it for
  /// the filter. Texels outside it (power-of-two padding) are never sent and never sampled.
  TexelBox stored;
  /// Cells that each node holds around its own cells: for the second samples of slice segments, for segments,
  /// and for gradients (see ghost_layer_needed()).
  int ghost_layer = 0;
  /// The cells of the lattice that are shown (volume/cell_lattice.h); unset: all. Images of parts that tile the
  /// lattice composite to the image of the whole, like those of ranks.
  std::optional<TexelBox> part;

  bool operator==(const VolumeDescription&) const = default;
};

}  // namespace understudy::volume
