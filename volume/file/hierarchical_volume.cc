// SPDX-License-Identifier: Apache-2.0
#include "volume/file/hierarchical_volume.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <new>
#include <set>
#include <utility>

#include "volume/file/file_error.h"
#include "volume/file/scalar_dispatch.h"
#include "volume/hierarchy/block_code.h"

namespace understudy::volume {
namespace {

template <typename Sample>
class TypedVolume : public HierarchicalVolume {
 public:
  using HierarchicalVolume::HierarchicalVolume;

  void read_level(int level, const TexelBox& box, std::span<std::byte> scalars) override {
    if (level < 0 || level >= grid().levels() || !contains({{0, 0, 0}, grid().size(level)}, box) ||
        scalars.size() != texels_in(box) * sizeof(Sample))
      throw FileError(fmt::format("{}: a part was asked for that the volume does not have", file().path()));
    if (is_empty(box)) return;
    const TexelBox needed = blocks_around(box);
    std::set<std::size_t> used;
    use(level, needed, used);
    std::erase_if(decoded_, [&](const auto& entry) { return !used.contains(entry.first); });
    try {
      decode(level, needed);
    } catch (const std::bad_alloc&) {
      throw FileError(fmt::format("{}: there is not enough memory for {} scalars; read a coarser level",
                                  file().path(), texels_in(box)));
    }
    for_each_block(needed, [&](const BlockPlace& place) {
      const TexelBox own = grid().samples_of(level, place);
      copy_texels(intersection(own, box), sizeof(Sample), own,
                  std::as_bytes(std::span(decoded_.at(grid().number_of(level, place)))), box, scalars);
    });
  }

 private:
  /// Adds these blocks, and the blocks of coarser levels from which they are decoded.
  void use(int level, const TexelBox& blocks, std::set<std::size_t>& used) const {
    for_each_block(blocks, [&](const BlockPlace& place) { used.insert(grid().number_of(level, place)); });
    if (level < grid().coarsest())
      use(level + 1, blocks_around(coarser_samples_around(samples_of(level, blocks), grid().size(level + 1))),
          used);
  }

  /// Makes sure that these blocks of a level are decoded.
  void decode(int level, const TexelBox& blocks) {
    std::vector<BlockPlace> missing;
    TexelBox around;
    for_each_block(blocks, [&](const BlockPlace& place) {
      if (decoded_.contains(grid().number_of(level, place))) return;
      missing.push_back(place);
      around = enclosing(around, grid().samples_of(level, place));
    });
    if (missing.empty()) return;
    if (level < grid().coarsest())
      decode(level + 1, blocks_around(coarser_samples_around(around, grid().size(level + 1))));
    std::vector<std::vector<std::byte>> packed;
    packed.reserve(missing.size());
    for (const BlockPlace& place : missing) packed.push_back(packed_bytes(grid().number_of(level, place)));
    std::vector<std::vector<Sample>> samples(missing.size());
    std::atomic<bool> good = true;
    tbb::parallel_for(std::size_t{0}, missing.size(), [&](std::size_t i) {
      if (!decode_one(level, missing[i], packed[i], samples[i])) good = false;
      packed[i] = {};
    });
    if (!good)
      throw FileError(
          fmt::format("{}: a block of level {} is damaged; get the file again, or convert the volume again",
                      file().path(), level));
    for (std::size_t i = 0; i < missing.size(); ++i)
      decoded_[grid().number_of(level, missing[i])] = std::move(samples[i]);
  }

  TexelBox samples_of(int level, const TexelBox& blocks) const {
    TexelBox samples;
    for_each_block(blocks, [&](const BlockPlace& place) {
      samples = enclosing(samples, grid().samples_of(level, place));
    });
    return samples;
  }

  std::vector<std::byte> packed_bytes(std::size_t number) {
    std::vector<std::byte> bytes(block(number).bytes);
    if (file().read(block(number).offset, bytes) < bytes.size())
      throw FileError(fmt::format("{}: truncated: it ends within a block; get the file again", file().path()));
    return bytes;
  }

  bool decode_one(int level, const BlockPlace& place, std::span<const std::byte> packed,
                  std::vector<Sample>& samples) const {
    const TexelBox own = grid().samples_of(level, place);
    if (level == grid().coarsest()) {
      samples.resize(texels_in(own));
      return decode_coarsest<Sample>(packed, samples);
    }
    const BlockExtent extent(own);
    std::vector<Sample> points(extent.points());
    put_even_points(level, own, extent, points);
    const BlockCoding coding{header().prediction, block(grid().number_of(level, place)).quantum};
    if (!decode_block<Sample>(extent, coding, packed, points)) return false;
    samples = samples_inside<Sample>(extent, points);
    return true;
  }

  /// Takes the even points from the next coarser level, whose outermost samples are repeated beyond its end.
  void put_even_points(int level, const TexelBox& own, const BlockExtent& extent,
                       std::vector<Sample>& points) const {
    const std::array<int, 3> end = grid().size(level + 1);
    const auto coarser = [&](std::size_t k, int i) { return std::min((own.low[k] + i) / 2, end[k] - 1); };
    for (int z = 0; z <= extent.last[2]; z += 2)
      for (int y = 0; y <= extent.last[1]; y += 2)
        for (int x = 0; x <= extent.last[0];) {
          // A run within one block.
          const std::array<int, 3> from{coarser(0, x), coarser(1, y), coarser(2, z)};
          BlockPlace place{};
          for (std::size_t k = 0; k < 3; ++k) place[k] = from[k] / hierarchy_block_edge;
          const TexelBox box = grid().samples_of(level + 1, place);
          const std::vector<Sample>& samples = decoded_.at(grid().number_of(level + 1, place));
          const auto row = (std::size_t(from[2] - box.low[2]) * std::size_t(box.high[1] - box.low[1]) +
                            std::size_t(from[1] - box.low[1])) *
                           std::size_t(box.high[0] - box.low[0]);
          do {
            points[extent.at(x, y, z)] = samples[row + std::size_t(coarser(0, x) - box.low[0])];
            x += 2;
          } while (x <= extent.last[0] && coarser(0, x) < box.high[0]);
        }
  }

  std::map<std::size_t, std::vector<Sample>> decoded_;  ///< the blocks needed for the last box, by number
};

}  // namespace

HierarchicalVolume::HierarchicalVolume(std::unique_ptr<ByteSource> file, const HierarchicalHeader& header)
    : VolumeFile(header.description),
      file_(std::move(file)),
      header_(header),
      grid_(header.description.size),
      blocks_(read_block_table(*file_, header_, grid_)) {}

double HierarchicalVolume::error_of_level(int level) const {
  if (level == 0) return header_.max_error;
  double most = 0;
  for (std::size_t number = grid_.first_of(level - 1); number < grid_.first_of(level - 2); ++number)
    most = std::max(most, blocks_[number].coarser_error);
  return most;
}

std::unique_ptr<HierarchicalVolume> open_hierarchical(const std::string& path, const ReadableFiles& files) {
  auto file = open_file(path, files);
  const HierarchicalHeader header = read_hierarchical_header(*file);
  std::unique_ptr<HierarchicalVolume> opened;
  bool held = false;
  try {
    held = with_sample_type(header.description.type, [&](auto sample) {
      opened = std::make_unique<TypedVolume<decltype(sample)>>(std::move(file), header);
    });
  } catch (const std::bad_alloc&) {
    throw FileError(fmt::format("{}: there is not enough memory for its table of blocks", path));
  }
  if (!held)
    throw FileError(fmt::format("{}: a hierarchical volume of {}, which none holds; convert the volume again",
                                path, name_of(header.description.type)));
  return opened;
}

namespace {

/// The values of the scalars from `low` to `high`.
std::array<double, 2> values_between(const FileDescription& description, double low, double high) {
  const double a = description.offset + description.scale * low;
  const double b = description.offset + description.scale * high;
  return {std::min(a, b), std::max(a, b)};
}

FileDescription description_of_level(const HierarchicalVolume& volume, int level, const std::string& path) {
  const LevelGrid& grid = volume.grid();
  if (level < 0 || level >= grid.levels())
    throw FileError(fmt::format("{}: has no level {}; its levels are 0 to {}", path, level, grid.levels() - 1));
  FileDescription description = volume.description();
  const HierarchicalBlock& all = volume.block(0);
  const std::array<double, 2> values = values_between(description, all.low, all.high);
  // Where infinite scalars hide the range of the others, only the samples tell it.
  if (all.low <= all.high && std::isfinite(values[0]) && std::isfinite(values[1])) description.values = values;
  if (level == 0) return description;
  LevelOfDetail& detail = description.detail.emplace();
  detail.level = level;
  detail.volume_size = description.size;
  detail.error = volume.error_of_level(level) * std::abs(description.scale);
  description.size = grid.size(level);
  for (double& distance : description.spacing) distance *= double(1 << level);
  return description;
}

class OneLevel : public VolumeFile {
 public:
  OneLevel(std::unique_ptr<HierarchicalVolume> volume, int level, const std::string& path)
      : VolumeFile(description_of_level(*volume, level, path)), volume_(std::move(volume)), level_(level) {}

  void read(const TexelBox& box, std::span<std::byte> scalars) override {
    volume_->read_level(level_, box, scalars);
  }
  std::uint64_t bytes_read() const override { return volume_->bytes_read(); }

  std::optional<std::array<double, 2>> values_in(const TexelBox& box) const override {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for_each_block(blocks_around(box), [&](const BlockPlace& place) {
      const HierarchicalBlock& block = volume_->block(volume_->grid().number_of(level_, place));
      if (block.low > block.high) return;
      // Encoding errors are at most half a quantum in this block, and max_error in samples of coarser levels.
      const double off = std::max(block.quantum / 2, volume_->header().max_error);
      low = std::min(low, block.low - off);
      high = std::max(high, block.high + off);
    });
    if (low > high) return std::array{1.0, 0.0};
    return values_between(description(), low, high);
  }

  /// Blocks are decoded as a whole, with the blocks of coarser levels from which they are predicted.
  std::size_t memory_to_read(const TexelBox& box) const override {
    const LevelGrid& grid = volume_->grid();
    constexpr std::size_t edge = std::size_t(hierarchy_block_edge);
    TexelBox samples = box;
    samples.high[2] += hierarchy_block_edge;  // the box may begin anywhere in a block
    std::size_t blocks = 0;
    for (int level = level_; level < grid.levels(); ++level) {
      const TexelBox whole = intersection(blocks_around(samples), {{0, 0, 0}, grid.blocks(level)});
      blocks += texels_in(whole);
      if (level == grid.coarsest()) break;
      for (std::size_t k = 0; k < 3; ++k) {
        samples.low[k] = whole.low[k] * hierarchy_block_edge;
        samples.high[k] = std::min(whole.high[k] * hierarchy_block_edge, grid.size(level)[k]);
      }
      samples = coarser_samples_around(samples, grid.size(level + 1));
    }
    // And a quarter of that for compressed blocks.
    return blocks * edge * edge * edge * bytes_per_scalar(description().type) * 5 / 4;
  }

 private:
  std::unique_ptr<HierarchicalVolume> volume_;
  int level_;
};

}  // namespace

std::unique_ptr<VolumeFile> open_level(const std::string& path, int level, const ReadableFiles& files) {
  return std::make_unique<OneLevel>(open_hierarchical(path, files), level, path);
}

}  // namespace understudy::volume
