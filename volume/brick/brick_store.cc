// SPDX-License-Identifier: Apache-2.0
#include "volume/brick/brick_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

namespace understudy::volume {

namespace {

constexpr int block_row = BrickStore::block_row;
constexpr int block_texels = BrickStore::block_texels;

float as_value(std::uint8_t v) {
  return v;
}
float as_value(std::uint16_t v) {
  return v;
}
float as_value(float v) {
  return v;
}

float sane(float v) {
  return std::clamp(v, -BrickStore::largest_value, BrickStore::largest_value);
}  // NaN stays NaN

/// The bits of one texel, which identify a constant block.
template <typename Texel>
std::uint32_t bits(Texel texel) {
  if constexpr (sizeof(Texel) == 4)
    return std::bit_cast<std::uint32_t>(texel);
  else
    return texel;
}

}  // namespace

namespace {

/// The cells that a store keeps: its own, and the volume's ghost layer around them.
TexelBox kept_cells(const VolumeDescription& volume, const CellLattice& lattice, const TexelBox& owned_cells) {
  const TexelBox all = lattice.box();
  TexelBox kept;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    kept.low[axis] = std::max(owned_cells.low[axis] - volume.ghost_layer, all.low[axis]);
    kept.high[axis] = std::min(owned_cells.high[axis] + volume.ghost_layer, all.high[axis]);
  }
  return kept;
}

/// The blocks that intersect `cells`, counted from the lattice's low corner.
TexelBox blocks_of(const CellLattice& lattice, const TexelBox& cells) {
  TexelBox blocks;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    blocks.low[axis] = (cells.low[axis] - lattice.origin[axis]) / block_cells;
    blocks.high[axis] = (cells.high[axis] - lattice.origin[axis] + block_cells - 1) / block_cells;
  }
  return blocks;
}

/// Bytes of a block, rounded up to a multiple of 16.
std::size_t bytes_of_block(TexelType type) {
  return (block_texels * bytes_per_texel(type) + 15) / 16 * 16;
}

}  // namespace

BrickStore::BrickStore(const VolumeDescription& volume, const TexelBox& owned_cells)
    : volume_(volume), lattice_(cell_lattice(volume)), owned_(owned_cells) {
  channels_ = volume.type == TexelType::rgba8 ? 4 : 1;
  block_bytes_ = bytes_of_block(volume.type);

  const float unit = volume.type == TexelType::f32 ? 1.0F : volume.type == TexelType::u16 ? 65535.0F : 255.0F;
  for (int k = 0; k < 4; ++k) {
    const float b = volume.border[k];
    border_[k] = volume.type == TexelType::f32 ? (std::isnan(b) ? 0.0F : sane(b))
                                               : (b > 0 ? std::min(b, 1.0F) * unit : 0.0F);
  }

  bool any = true;
  const TexelBox all = lattice_.box();
  for (int axis = 0; axis < 3; ++axis) {
    if (owned_.low[axis] < all.low[axis] || owned_.high[axis] > all.high[axis] ||
        owned_.low[axis] > owned_.high[axis])
      throw std::invalid_argument(
          fmt::format("volume {}: cells {} to {} along axis {} are outside the volume's {} to {}", volume.id,
                      owned_.low[axis], owned_.high[axis], axis, all.low[axis], all.high[axis]));
    any = any && owned_.low[axis] < owned_.high[axis];
  }
  if (!any) return;
  shown_ = texels_shown(volume, owned_cells);
  slice_seen_.resize(std::size_t(shown_.high[2] - shown_.low[2]));
  const TexelBox held = blocks_of(lattice_, kept_cells(volume, lattice_, owned_));
  first_block_ = held.low;
  for (int axis = 0; axis < 3; ++axis) block_counts_[axis] = held.high[axis] - held.low[axis];
  const std::size_t count = texels_in(held);
  if (count > max_blocks)
    throw std::invalid_argument(
        fmt::format("volume {}: {} blocks on one rank (at most {} are possible): divide it among more ranks",
                    volume.id, count, max_blocks));
  blocks_.resize(count);
  constant_.resize(count);
  ranges_.resize(count * channels_);
  layers_.resize(std::size_t(block_counts_[2]));
}

TexelBox BrickStore::texels_shown(const VolumeDescription& volume, const TexelBox& owned_cells) {
  if (is_empty(owned_cells)) return {};
  const CellLattice lattice = cell_lattice(volume);
  const TexelBox kept = kept_cells(volume, lattice, owned_cells);
  TexelBox shown;
  for (int axis = 0; axis < 3; ++axis) {
    const int first = (kept.low[axis] - lattice.origin[axis]) / block_cells * block_cells;
    const int blocks = (kept.high[axis] - lattice.origin[axis] - first + block_cells - 1) / block_cells;
    const int last = std::min(first + blocks * block_cells, lattice.cells[axis]);
    shown.low[axis] = shown.high[axis] = lattice_texel(volume, lattice, axis, first);
    // A repeating axis may show both of its ends.
    for (int point = first; point <= last; ++point) {
      const int texel = lattice_texel(volume, lattice, axis, point);
      shown.low[axis] = std::min(shown.low[axis], texel);
      shown.high[axis] = std::max(shown.high[axis], texel + 1);
    }
  }
  return shown;
}

void BrickStore::check_size(const TexelBox& box, std::size_t bytes) const {
  const TexelBox& stored = volume_.stored;
  if (is_empty(box) || !contains(stored, box))
    throw std::invalid_argument(fmt::format(
        "volume {}: texels ({}, {}, {}) to ({}, {}, {}) are not among the stored ({}, {}, {}) to ({}, {}, {})",
        volume_.id, box.low[0], box.low[1], box.low[2], box.high[0], box.high[1], box.high[2], stored.low[0],
        stored.low[1], stored.low[2], stored.high[0], stored.high[1], stored.high[2]));
  if (const std::size_t expected = texels_in(box) * bytes_per_texel(volume_.type); bytes != expected)
    throw std::invalid_argument(
        fmt::format("volume {}: {} bytes of texels instead of {}", volume_.id, bytes, expected));
}

void BrickStore::add_slices(const TexelBox& slice_range, std::span<const std::byte> texels) {
  check_size(slice_range, texels.size());
  if (blocks_.empty()) return;
  for (int axis = 0; axis < 2; ++axis)
    if (slice_range.low[axis] > shown_.low[axis] || slice_range.high[axis] < shown_.high[axis])
      throw std::invalid_argument(fmt::format(
          "volume {}: a slice range covers texels {} to {} along axis {}, not {} to {}", volume_.id,
          slice_range.low[axis], slice_range.high[axis], axis, shown_.low[axis], shown_.high[axis]));
  const std::size_t slice_bytes = texels.size() / std::size_t(slice_range.high[2] - slice_range.low[2]);
  for (int texel_z = std::max(slice_range.low[2], shown_.low[2]);
       texel_z < std::min(slice_range.high[2], shown_.high[2]); ++texel_z) {
    const auto index = std::size_t(texel_z - shown_.low[2]);
    if (slice_seen_[index])
      throw std::invalid_argument(fmt::format("volume {}: slice {} came twice", volume_.id, texel_z));
    slice_seen_[index] = true;
    const std::byte* slice = texels.data() + std::size_t(texel_z - slice_range.low[2]) * slice_bytes;
    // Wrapped and clamped axes show one slice at several lattice points.
    const int first = first_block_[2] * block_cells, last = first + block_counts_[2] * block_cells;
    for (int z = first; z <= last; ++z)
      if (lattice_texel(volume_, lattice_, 2, std::min(z, lattice_.cells[2])) == texel_z)
        place_slice(z, slice_range, slice);
  }
}

void BrickStore::place_slice(int lattice_z, const TexelBox& slice_range, const std::byte* slice) {
  // A slice on a block face belongs to both neighbouring layers.
  for (int layer = (lattice_z - 1) / block_cells; layer <= lattice_z / block_cells; ++layer) {
    const int index = layer - first_block_[2];
    if (index < 0 || index >= block_counts_[2] || lattice_z < layer * block_cells) continue;
    Layer& target = layers_[std::size_t(index)];
    if (target.texels.empty())
      target.texels.resize(std::size_t(block_counts_[0]) * std::size_t(block_counts_[1]) * block_texels *
                           bytes_per_texel(volume_.type));
    const int z_in_block = lattice_z - layer * block_cells;
    switch (volume_.type) {
      case TexelType::u8:
        fill_layer_slice<std::uint8_t>(target, z_in_block, slice_range, slice);
        break;
      case TexelType::u16:
        fill_layer_slice<std::uint16_t>(target, z_in_block, slice_range, slice);
        break;
      case TexelType::f32:
        fill_layer_slice<float>(target, z_in_block, slice_range, slice);
        break;
      case TexelType::rgba8:
        fill_layer_slice<std::uint32_t>(target, z_in_block, slice_range, slice);
        break;
    }
    if (--target.slices_missing == 0) complete_layer(index);
  }
}

template <typename Texel>
void BrickStore::fill_layer_slice(Layer& layer, int z_in_block, const TexelBox& slice_range,
                                  const std::byte* slice) {
  const int row_texels = slice_range.high[0] - slice_range.low[0];
  // The index in the slice of the texel at each lattice point of the layer.
  const auto sources = [&](int axis) {
    std::vector<int> source;
    for (int block = 0; block < block_counts_[axis]; ++block)
      for (int k = 0; k < block_row; ++k) {
        const int point = std::min((first_block_[axis] + block) * block_cells + k, lattice_.cells[axis]);
        source.push_back(lattice_texel(volume_, lattice_, axis, point) - slice_range.low[axis]);
      }
    return source;
  };
  const std::vector<int> columns = sources(0), rows = sources(1);
  std::vector<Texel> row(static_cast<std::size_t>(row_texels));
  for (int by = 0; by < block_counts_[1]; ++by)
    for (int y = 0; y < block_row; ++y) {
      std::memcpy(row.data(), slice + std::size_t(rows[by * block_row + y]) * row.size() * sizeof(Texel),
                  row.size() * sizeof(Texel));
      if constexpr (std::is_same_v<Texel, float>)
        for (float& v : row) v = sane(v);
      for (int bx = 0; bx < block_counts_[0]; ++bx) {
        std::array<Texel, block_row> piece;
        for (int x = 0; x < block_row; ++x) piece[x] = row[std::size_t(columns[bx * block_row + x])];
        const std::size_t block = std::size_t(by) * block_counts_[0] + bx;
        std::memcpy(
            layer.texels.data() +
                (block * block_texels + std::size_t(z_in_block * block_slice + y * block_row)) * sizeof(Texel),
            piece.data(), sizeof piece);
      }
    }
}

void BrickStore::complete_layer(int layer_index) {
  switch (volume_.type) {
    case TexelType::u8:
      compact_layer<std::uint8_t>(layer_index);
      break;
    case TexelType::u16:
      compact_layer<std::uint16_t>(layer_index);
      break;
    case TexelType::f32:
      compact_layer<float>(layer_index);
      break;
    case TexelType::rgba8:
      compact_layer<std::uint32_t>(layer_index);
      break;
  }
  layers_[std::size_t(layer_index)].texels = std::vector<std::byte>();
}

template <typename Texel>
void BrickStore::compact_layer(int layer_index) {
  const std::size_t in_layer = std::size_t(block_counts_[0]) * std::size_t(block_counts_[1]);
  const std::byte* source = layers_[std::size_t(layer_index)].texels.data();
  std::array<Texel, block_texels> texels;
  for (std::size_t b = 0; b < in_layer; ++b, source += sizeof texels) {
    std::memcpy(texels.data(), source, sizeof texels);
    const std::size_t block = std::size_t(layer_index) * in_layer + b;
    store_block(block, texels.data());
  }
}

template <typename Texel>
void BrickStore::store_block(std::size_t block, const Texel* texels) {
  add_ranges(block, texels);
  const auto value = bits(texels[0]);
  constant_[block] = std::all_of(texels, texels + block_texels, [&](Texel t) { return bits(t) == value; });
  if (!constant_[block]) {
    std::byte* place = allocate_block();
    std::memcpy(place, texels, sizeof(Texel) * block_texels);
    blocks_[block] = place;
    return;
  }
  Shared& shared = constant_blocks_[value];
  if (shared.users++ == 0) {
    shared.place = allocate_block();
    std::memcpy(shared.place, texels, sizeof(Texel) * block_texels);
  }
  blocks_[block] = shared.place;
}

std::vector<std::vector<BrickStore::Point>> BrickStore::points_in(const TexelBox& box, int axis) const {
  const auto blocks = std::size_t(block_counts_[axis]);
  std::vector<std::vector<Point>> points(blocks);
  for (int block = 0; block < block_counts_[axis]; ++block)
    for (int k = 0; k < block_row; ++k) {
      const int point = std::min((first_block_[axis] + block) * block_cells + k, lattice_.cells[axis]);
      const int texel = lattice_texel(volume_, lattice_, axis, point);
      if (texel >= box.low[axis] && texel < box.high[axis])
        points[std::size_t(block)].push_back({k, texel - box.low[axis]});
    }
  return points;
}

std::vector<std::size_t> BrickStore::blocks_that_show(const TexelBox& box) const {
  std::vector<std::size_t> shown;
  if (blocks_.empty()) return shown;
  const std::array<std::vector<std::vector<Point>>, 3> points{points_in(box, 0), points_in(box, 1),
                                                              points_in(box, 2)};
  std::size_t block = 0;
  for (const auto& z : points[2])
    for (const auto& y : points[1])
      for (const auto& x : points[0]) {
        if (!x.empty() && !y.empty() && !z.empty()) shown.push_back(block);
        ++block;
      }
  return shown;
}

void BrickStore::change(const TexelBox& box, std::span<const std::byte> texels,
                        std::vector<std::size_t>& changed) {
  if (!finished_)
    throw std::invalid_argument(fmt::format("volume {}: texels change before all have come", volume_.id));
  check_size(box, texels.size());
  if (blocks_.empty()) return;
  const std::array<std::vector<std::vector<Point>>, 3> points{points_in(box, 0), points_in(box, 1),
                                                              points_in(box, 2)};
  const auto columns = std::size_t(block_counts_[0]), rows = std::size_t(block_counts_[1]);
  for (const std::size_t here : blocks_that_show(box)) {
    const std::vector<Point>& x = points[0][here % columns];
    const std::vector<Point>& y = points[1][here / columns % rows];
    const std::vector<Point>& z = points[2][here / (columns * rows)];
    switch (volume_.type) {
      case TexelType::u8:
        change_block<std::uint8_t>(here, {x, y, z}, box, texels.data());
        break;
      case TexelType::u16:
        change_block<std::uint16_t>(here, {x, y, z}, box, texels.data());
        break;
      case TexelType::f32:
        change_block<float>(here, {x, y, z}, box, texels.data());
        break;
      case TexelType::rgba8:
        change_block<std::uint32_t>(here, {x, y, z}, box, texels.data());
        break;
    }
    changed.push_back(here);
  }
}

template <class Call>
void BrickStore::with_texel(Call call) const {
  switch (volume_.type) {
    case TexelType::u8:
      return call(std::uint8_t{});
    case TexelType::u16:
      return call(std::uint16_t{});
    case TexelType::f32:
      return call(float{});
    case TexelType::rgba8:
      return call(std::uint32_t{});
  }
}

template <typename Texel>
void BrickStore::give_up_block(std::size_t block) {
  auto* place = const_cast<std::byte*>(blocks_[block]);  // in a chunk of this store
  if (constant_[block]) {
    Texel value;
    std::memcpy(&value, place, sizeof value);
    const auto shared = constant_blocks_.find(bits(value));
    if (--shared->second.users == 0) {
      constant_blocks_.erase(shared);
      free_blocks_.push_back(place);
    }
  } else {
    free_blocks_.push_back(place);
  }
}

void BrickStore::give_up_block(std::size_t block) {
  with_texel([&](auto texel) { give_up_block<decltype(texel)>(block); });
}

template <typename Texel>
void BrickStore::unpack(std::size_t block, std::span<const std::byte> packed) {
  std::array<Texel, block_texels> texels;
  if (packed.size() == sizeof texels) {
    std::memcpy(texels.data(), packed.data(), sizeof texels);
  } else if (packed.size() == sizeof(Texel)) {
    Texel texel;
    std::memcpy(&texel, packed.data(), sizeof texel);
    texels.fill(texel);
  } else {
    throw std::logic_error("a block of texels has the wrong size");
  }
  store_block(block, texels.data());
}

void BrickStore::unpack(std::size_t block, std::span<const std::byte> packed) {
  with_texel([&](auto texel) { unpack<decltype(texel)>(block, packed); });
}

template <typename Texel>
void BrickStore::change_block(std::size_t block, const std::array<std::span<const Point>, 3>& points,
                              const TexelBox& box, const std::byte* texels) {
  std::array<Texel, block_texels> here;
  std::memcpy(here.data(), blocks_[block], sizeof here);
  const std::size_t row = std::size_t(box.high[0] - box.low[0]);
  const std::size_t slice = row * std::size_t(box.high[1] - box.low[1]);
  for (const Point& z : points[2])
    for (const Point& y : points[1]) {
      const std::byte* from =
          texels + (std::size_t(z.texel) * slice + std::size_t(y.texel) * row) * sizeof(Texel);
      Texel* to = here.data() + z.in_block * block_slice + y.in_block * block_row;
      for (const Point& x : points[0]) {
        Texel value;
        std::memcpy(&value, from + std::size_t(x.texel) * sizeof(Texel), sizeof value);
        if constexpr (std::is_same_v<Texel, float>) value = sane(value);
        to[x.in_block] = value;
      }
    }

  give_up_block<Texel>(block);
  store_block(block, here.data());
}

template <typename Texel>
void BrickStore::add_ranges(std::size_t block, const Texel* texels) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Range* ranges = ranges_.data() + block * channels_;
  if constexpr (std::is_same_v<Texel, std::uint32_t>) {
    std::array<std::uint8_t, 4> low{255, 255, 255, 255}, high{};
    for (int i = 0; i < block_texels; ++i) {
      const auto rgba = std::bit_cast<std::array<std::uint8_t, 4>>(texels[i]);
      for (int k = 0; k < 4; ++k) {
        low[k] = std::min(low[k], rgba[k]);
        high[k] = std::max(high[k], rgba[k]);
      }
    }
    for (int k = 0; k < 4; ++k) ranges[k] = {float(low[k]), float(high[k])};
  } else {
    float low = infinity, high = -infinity;
    for (int i = 0; i < block_texels; ++i) {
      const float v = as_value(texels[i]);
      low = v < low ? v : low;  // comparisons are false for NaN
      high = v > high ? v : high;
    }
    *ranges = {low, high};
  }

  const std::size_t nx = std::size_t(block_counts_[0]), ny = std::size_t(block_counts_[1]);
  const std::array<int, 3> position{int(block % nx), int(block / nx % ny), int(block / (nx * ny))};
  for (int axis = 0; axis < 3; ++axis) {
    if (volume_.wrap[axis] != Wrap::border) continue;
    const int index = first_block_[axis] + position[axis];
    const bool at_low = index == 0, at_high = (index + 1) * block_cells >= lattice_.cells[axis];
    if (!at_low && !at_high) continue;
    for (std::size_t k = 0; k < channels_; ++k) {
      ranges[k].low = std::min(ranges[k].low, border_[k]);
      ranges[k].high = std::max(ranges[k].high, border_[k]);
    }
  }
}

std::byte* BrickStore::allocate_block() {
  if (!free_blocks_.empty()) {
    std::byte* place = free_blocks_.back();
    free_blocks_.pop_back();
    return place;
  }
  if (shared_) return allocate_shared_block();
  if (chunks_.empty() || chunk_used_ == blocks_per_chunk) {
    chunks_.push_back(std::make_unique<std::byte[]>(blocks_per_chunk * block_bytes_));
    chunk_used_ = 0;
  }
  return chunks_.back().get() + chunk_used_++ * block_bytes_;
}

void BrickStore::finish() {
  for (std::size_t i = 0; i < slice_seen_.size(); ++i)
    if (!slice_seen_[i])
      throw std::invalid_argument(
          fmt::format("volume {}: slice {} never came", volume_.id, int(i) + shown_.low[2]));
  layers_.clear();
  finished_ = true;
}

std::size_t BrickStore::bytes() const {
  std::size_t sum = sizeof *this + (chunks_.size() * blocks_per_chunk + shared_used_) * block_bytes_ +
                    blocks_.capacity() * sizeof(blocks_[0]) + ranges_.capacity() * sizeof(Range);
  for (const Layer& layer : layers_) sum += layer.texels.capacity();
  return sum;
}

std::size_t BrickStore::most_bytes(const VolumeDescription& volume, const TexelBox& owned_cells) {
  if (is_empty(owned_cells)) return sizeof(BrickStore);
  const CellLattice lattice = cell_lattice(volume);
  const TexelBox blocks = blocks_of(lattice, kept_cells(volume, lattice, owned_cells));
  const std::size_t count = texels_in(blocks);
  const std::size_t in_layer = count / std::size_t(blocks.high[2] - blocks.low[2]);
  const std::size_t channels = volume.type == TexelType::rgba8 ? 4 : 1;
  const std::size_t of_block =
      bytes_of_block(volume.type) + sizeof(const std::byte*) + channels * sizeof(Range) + sizeof(bool);
  // A slice on block faces belongs to two layers, which are stored densely while their slices arrive.
  constexpr std::size_t layers_at_once = 2;
  return sizeof(BrickStore) + (count + blocks_per_chunk) * of_block +
         layers_at_once * in_layer * block_texels * bytes_per_texel(volume.type);
}

}  // namespace understudy::volume
