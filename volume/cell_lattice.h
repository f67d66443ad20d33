// SPDX-License-Identifier: Apache-2.0
// The cells of a volume. A cell is the cube between eight neighbouring texel centres, on which trilinear
// interpolation is a single polynomial; along an axis, cell c spans texels c and c + 1.
//
// A sample at texture coordinate t has the position u = t N - 1/2 in texels. It is clamped to the lattice and
// belongs to cell floor(u); the last cell is closed, so every sample has exactly one cell. Wrap::repeat adds
// the cells that connect both ends of the texture (cells -1 and N - 1).
#pragma once

#include <array>

#include "volume/description.h"
#include "volume/texture_space.h"

namespace understudy::volume {

/// Longest texture axis that is accepted, in texels.
constexpr int max_axis_texels = 16384;

/// Edge of a block, the unit of empty-space skipping, in cells.
constexpr int block_cells = 8;

struct CellLattice {
  std::array<int, 3> origin{};  ///< lowest cell
  std::array<int, 3> cells{};   ///< number of cells, at least one

  TexelBox box() const { return {origin, {origin[0] + cells[0], origin[1] + cells[1], origin[2] + cells[2]}}; }
};

/// The cells that samples of `volume` can fall in. An axis with one stored texel has one cell, and both ends of
/// that cell are this texel. Throws std::invalid_argument for an invalid size or stored box.
CellLattice cell_lattice(const VolumeDescription& volume);

/// The cells of the lattice that are shown: the volume's part, or all. Throws std::invalid_argument if the part
/// is empty or not inside the lattice.
TexelBox shown_cells(const VolumeDescription& volume);

/// The texel (in texture coordinates) at lattice point `index` along `axis`, 0 <= index <= cells.
int lattice_texel(const VolumeDescription& volume, const CellLattice& lattice, int axis, int index);

/// The part of texture space whose samples fall in `cells`, slightly enlarged for the rounding of sample
/// positions. Sides on the boundary of the lattice are infinite, because positions are clamped there.
Box texture_box(const VolumeDescription& volume, const TexelBox& cells);

/// Whether `region` covers a texture of this size, except possibly its outer half texels, where the field is
/// constant.
bool is_all_of_texture(const Box& region, const std::array<int, 3>& size);

}  // namespace understudy::volume
