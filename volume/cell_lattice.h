// SPDX-License-Identifier: Apache-2.0
// Where the cells of a volume lie. A cell is the cube between eight neighbouring texel centres, the piece on
// which the trilinear filter is one polynomial; along an axis, cell c spans the texels c and c + 1.
//
// The position of a sample is u = t N - 1/2 in texels. It is clamped to the lattice and belongs to the cell
// floor(u), the last cell being closed: every sample has exactly one cell. Wrap::repeat adds the cells that
// join both ends of the texture (cells -1 and N - 1).
#pragma once

#include <array>

#include "volume/description.h"
#include "volume/texture_space.h"

namespace understudy::volume {

/// Longest texture axis that is believed.
constexpr int max_axis_texels = 16384;

/// Edge of a block, the unit of empty-space skipping, in cells.
constexpr int block_cells = 8;

struct CellLattice {
  std::array<int, 3> origin{};  ///< lowest cell
  std::array<int, 3> cells{};   ///< how many, at least one

  TexelBox box() const { return {origin, {origin[0] + cells[0], origin[1] + cells[1], origin[2] + cells[2]}}; }
};

/// The cells that samples of `volume` can fall in. An axis of one stored texel has one cell, both ends of
/// which are that texel. Throws std::invalid_argument when size or stored box make no sense.
CellLattice cell_lattice(const VolumeDescription& volume);

/// Of them, those that are shown: the volume's part, or all. Throws std::invalid_argument where the part is
/// empty or lies outside.
TexelBox shown_cells(const VolumeDescription& volume);

/// The texel (in texture coordinates) behind lattice point `index` of `axis`, 0 <= index <= cells.
int lattice_texel(const VolumeDescription& volume, const CellLattice& lattice, int axis, int index);

/// The part of texture space whose samples fall in `cells`, a little enlarged for the rounding of sample
/// positions. Sides on the rim of the lattice are infinite, as the clamp is.
Box texture_box(const VolumeDescription& volume, const TexelBox& cells);

/// Whether a box reaches the ends of a texture of so many texels, but for the half texel that is even there.
bool is_all_of_texture(const Box& region, const std::array<int, 3>& size);

}  // namespace understudy::volume
