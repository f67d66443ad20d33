// SPDX-License-Identifier: Apache-2.0
#include "volume/reference/stored_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "volume/description.h"
#include "volume/matrix.h"

namespace understudy::volume {
namespace {

/// Normalised values of the eight corners of a cell, x fastest.
struct Corners {
  std::array<std::array<double, 4>, 8> value{};
};

double component(const std::byte* texel, TexelType type, std::size_t k) {
  switch (type) {
    case TexelType::u8:
      return std::to_integer<int>(texel[0]) / 255.0;
    case TexelType::rgba8:
      return std::to_integer<int>(texel[k]) / 255.0;
    case TexelType::u16: {
      std::uint16_t word = 0;
      std::memcpy(&word, texel, sizeof word);
      return word / 65535.0;
    }
    case TexelType::f32:
      break;
  }
  float number = 0;
  std::memcpy(&number, texel, sizeof number);
  return double(number);
}

class OwnCells {
 public:
  explicit OwnCells(const BrickStore& store)
      : store_(store),
        type_(store.description().type),
        components_(type_ == TexelType::rgba8 ? 4 : 1),
        stride_(bytes_per_texel(type_)),
        lattice_(store.lattice()),
        owned_(store.owned_cells()) {}

  /// Whether the stretch with this middle, in texels, lies in a cell of our own; sets `cell` to it.
  bool find(const Vec3& middle, std::array<int, 3>& cell) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int low = lattice_.origin[axis], last = low + lattice_.cells[axis] - 1;
      // In this order, NaN, the middle of a path that is too long for a double, becomes `last`.
      cell[axis] = int(std::max(double(low), std::min(double(last), std::floor(middle[axis]))));
      if (cell[axis] < owned_.low[axis] || cell[axis] >= owned_.high[axis]) return false;
    }
    return true;
  }

  bool read(const std::array<int, 3>& cell, Corners& corners) const {
    std::array<int, 3> block{};
    std::size_t first = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int in_lattice = cell[axis] - lattice_.origin[axis];
      block[axis] = in_lattice / BrickStore::block_cells - store_.first_block()[axis];
      constexpr std::array<int, 3> row{1, BrickStore::block_row, BrickStore::block_slice};
      first += std::size_t((in_lattice % BrickStore::block_cells) * row[axis]);
    }
    const auto& counts = store_.block_counts();
    const std::size_t index =
        (std::size_t(block[2]) * std::size_t(counts[1]) + std::size_t(block[1])) * std::size_t(counts[0]) +
        std::size_t(block[0]);
    const std::byte* const texels = store_.block_data()[index];
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const std::size_t texel = first + (corner & 1) + (corner >> 1 & 1) * std::size_t(BrickStore::block_row) +
                                (corner >> 2) * std::size_t(BrickStore::block_slice);
      for (std::size_t k = 0; k < components_; ++k) {
        const double value = component(texels + texel * stride_, type_, k);
        if (std::isnan(value)) return false;
        corners.value[corner][k] = value;
      }
    }
    return true;
  }

  /// The field at `place`, in texels, from the corners of the cell that contains or adjoins it.
  void value_at(const Vec3& place, const std::array<int, 3>& cell, const Corners& corners,
                std::array<double, 4>& value) const {
    const VolumeDescription& volume = store_.description();
    Vec3 fraction{};
    double inside = 1;  // weight of the texture; the rest is the weight of its border
    for (std::size_t axis = 0; axis < 3; ++axis) {
      fraction[axis] = std::clamp(place[axis] - cell[axis], 0.0, 1.0);
      if (volume.wrap[axis] != Wrap::border) continue;
      const double outside = std::max({0.0, -place[axis], place[axis] - (volume.size[axis] - 1)});
      inside *= 1 - std::min(outside, 1.0);
    }
    for (std::size_t k = 0; k < components_; ++k) {
      const auto along_x = [&](std::size_t i) {
        return std::lerp(corners.value[i][k], corners.value[i + 1][k], fraction[0]);
      };
      const double near = std::lerp(along_x(0), along_x(2), fraction[1]);
      const double far = std::lerp(along_x(4), along_x(6), fraction[1]);
      value[k] = std::lerp(near, far, fraction[2]);
      if (inside < 1) value[k] = std::lerp(double(volume.border[k]), value[k], inside);
    }
  }

 private:
  const BrickStore& store_;
  TexelType type_;
  std::size_t components_;
  std::size_t stride_;
  const CellLattice& lattice_;
  const TexelBox& owned_;
};

/// The positions, as fractions of the path, where the ray passes from one cell to the next; includes 0 and 1.
std::vector<double> faces_on(const Vec3& begin, const Vec3& way, const std::array<int, 3>& size) {
  std::vector<double> cuts{0, 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (way[axis] == 0) continue;
    const auto [first, last] = faces_between(begin[axis], begin[axis] + way[axis], size[axis]);
    for (int face = first; face <= last; ++face) {
      const double s = (double(face) - begin[axis]) / way[axis];
      if (s > 0 && s < 1) cuts.push_back(s);
    }
  }
  std::ranges::sort(cuts);
  return cuts;
}

}  // namespace

std::vector<Stretch> stored_field_along_ray(const BrickStore& store, const Vec3& from, const Vec3& to,
                                            double length) {
  std::vector<Stretch> stretches;
  if (store.empty()) return stretches;
  const auto& size = store.description().size;
  Vec3 begin{}, way{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    begin[axis] = from[axis] * size[axis] - 0.5;
    way[axis] = (to[axis] - from[axis]) * size[axis];
  }
  const std::vector<double> cuts = faces_on(begin, way, size);
  const OwnCells cells(store);
  std::array<int, 3> cell{};
  Corners corners;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double width = cuts[i + 1] - cuts[i];
    if (!(width > 0)) continue;
    const auto at = [&](double s) { return add(begin, scale(way, s)); };
    if (!cells.find(at(cuts[i] + width / 2), cell) || !cells.read(cell, corners)) continue;
    std::array<std::array<double, 4>, 4> values{};  // by position
    for (std::size_t p = 0; p < 4; ++p)
      cells.value_at(at(cuts[i] + width * double(p) / 3), cell, corners, values[p]);
    Stretch& stretch = stretches.emplace_back();
    stretch.length = width * length;
    for (std::size_t k = 0; k < 4; ++k)
      stretch.value[k] = cubic_through({values[0][k], values[1][k], values[2][k], values[3][k]});
  }
  return stretches;
}

}  // namespace understudy::volume
