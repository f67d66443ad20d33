// SPDX-License-Identifier: Apache-2.0
#include "volume/file/hierarchical_writer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "volume/file/file_error.h"
#include "volume/file/hierarchical_format.h"
#include "volume/file/part_file.h"
#include "volume/file/scalar_dispatch.h"
#include "volume/hierarchy/block_code.h"
#include "volume/hierarchy/level_grid.h"

namespace understudy::volume {
namespace {

/// Ranges of slices, each one block high.
std::vector<std::array<int, 2>> layers(int depth) {
  std::vector<std::array<int, 2>> found;
  for (int low = 0; low < depth; low += hierarchy_block_edge)
    found.push_back({low, std::min(low + hierarchy_block_edge, depth)});
  return found;
}

/// Quantum for a Quantiser with at most this error, in scalars; 0: lossless.
template <typename Sample>
double quantum_of(double error) {
  if constexpr (std::is_floating_point_v<Sample>) return 2 * error;
  const double whole = std::floor(error);
  return whole >= 1 ? 2 * whole + 1 : 0;
}

template <typename Sample>
double error_of(double quantum) {
  return std::is_floating_point_v<Sample> ? quantum / 2 : std::floor(quantum / 2);
}

/// The samples of a level, or of some of its slices.
template <typename Sample>
struct Samples {
  TexelBox box;
  std::vector<Sample> values;

  explicit Samples(const TexelBox& where) : box(where), values(texels_in(where)) {}
  std::size_t at(int x, int y, int z) const {
    return (std::size_t(z - box.low[2]) * std::size_t(box.high[1] - box.low[1]) + std::size_t(y - box.low[1])) *
               std::size_t(box.high[0] - box.low[0]) +
           std::size_t(x - box.low[0]);
  }
};

template <typename Sample>
class HierarchyWriter {
 public:
  HierarchyWriter(VolumeFile& volume, const std::string& path, const HierarchyOptions& options,
                  const std::function<void(double)>& progress)
      : volume_(volume),
        options_(options),
        progress_(progress),
        grid_(volume.description().size),
        quantum_(
            quantum_of<Sample>(options.max_error / std::max(std::abs(volume.description().scale), 1e-300))),
        blocks_(grid_.count()),
        file_(path) {}

  HierarchyFigures write();

 private:
  struct CodedBlock {
    std::vector<std::byte> bytes;
    HierarchicalBlock entry;
  };

  Samples<Sample> slices(int low, int high, int step);
  Samples<Sample> every_second(const Samples<Sample>& finer) const;
  void write_coarsest(const Samples<Sample>& samples);
  /// Writes the blocks of a level in these slices of `samples`, and replaces the samples by their decoded
  /// values.
  void write_blocks(int level, const Samples<Sample>& coarser, std::array<int, 2> slices,
                    Samples<Sample>& samples);
  CodedBlock coded(int level, const BlockPlace& place, const Samples<Sample>& coarser,
                   Samples<Sample>& samples) const;
  void gather_ranges();
  void gather_errors();
  double largest_error_of(int level, TexelBox blocks, std::span<const double> errors) const;
  HierarchyFigures figures() const;
  void report(double part) const {
    if (progress_) progress_(part);
  }

  VolumeFile& volume_;
  HierarchyOptions options_;
  const std::function<void(double)>& progress_;
  LevelGrid grid_;
  double quantum_;
  std::vector<HierarchicalBlock> blocks_;
  PartFile file_;
};

/// Reads every `step`-th slice from `low` on; slice z gets the index z / step.
template <typename Sample>
Samples<Sample> HierarchyWriter<Sample>::slices(int low, int high, int step) {
  const auto [width, height, depth] = grid_.size(0);
  Samples<Sample> read({{0, 0, low / step}, {width, height, (high - 1) / step + 1}});
  if (step == 1) {
    volume_.read({{0, 0, low}, {width, height, high}}, std::as_writable_bytes(std::span(read.values)));
    return read;
  }
  const std::size_t slice = std::size_t(width) * std::size_t(height);
  for (int z = low; z < high; z += step)
    volume_.read(
        {{0, 0, z}, {width, height, z + 1}},
        std::as_writable_bytes(std::span(read.values).subspan(std::size_t((z - low) / step) * slice, slice)));
  return read;
}

template <typename Sample>
Samples<Sample> HierarchyWriter<Sample>::every_second(const Samples<Sample>& finer) const {
  TexelBox box = finer.box;
  for (int& n : box.high) n = (n + 1) / 2;
  Samples<Sample> coarser(box);
  tbb::parallel_for(box.low[2], box.high[2], [&](int z) {
    for (int y = box.low[1]; y < box.high[1]; ++y)
      for (int x = box.low[0]; x < box.high[0]; ++x)
        coarser.values[coarser.at(x, y, z)] = finer.values[finer.at(2 * x, 2 * y, 2 * z)];
  });
  return coarser;
}

template <typename Sample>
void HierarchyWriter<Sample>::write_coarsest(const Samples<Sample>& samples) {
  const auto packed = coded_coarsest<Sample>(samples.values, options_.effort);
  HierarchicalBlock& entry = blocks_.front();
  entry.offset = file_.size();
  entry.bytes = std::uint32_t(packed.size());
  file_.append(packed);
}

/// Records the least and the greatest sample, ignoring NaN.
template <typename Sample>
void note_range(std::span<const Sample> samples, HierarchicalBlock& entry) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Sample sample : samples) {
    const auto value = double(sample);
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low <= high) {
    entry.low = low;
    entry.high = high;
  }
}

/// The largest difference between the samples of a block and the interpolation of its even points; infinite if
/// some are not finite.
template <typename Sample>
double distance_from_interpolation(const BlockExtent& extent, std::span<const Sample> points) {
  std::vector<double> smooth(points.begin(), points.end());
  if (!std::ranges::all_of(smooth, [](double value) { return std::isfinite(value); }))
    return std::numeric_limits<double>::infinity();
  double most = 0;
  fill_between(extent, Prediction::linear, smooth.data(),
               [&](const std::array<int, 3>& place, int stride, double* row, int count) {
                 const Sample* own = points.data() + extent.at(place[0], place[1], place[2]);
                 for (int i = 0; i < count; ++i)
                   most = std::max(most, std::abs(row[i] - double(own[i * stride])));
               });
  constexpr double rounded_up = 1 + 1e-12;
  return most * rounded_up;
}

template <typename Sample>
auto HierarchyWriter<Sample>::coded(int level, const BlockPlace& place, const Samples<Sample>& coarser,
                                    Samples<Sample>& samples) const -> CodedBlock {
  const TexelBox box = grid_.samples_of(level, place);
  const BlockExtent extent(box);
  const std::array<int, 3> end = grid_.size(level + 1);
  std::vector<Sample> points(extent.points());
  for (int z = 0; z <= extent.last[2]; z += 2)
    for (int y = 0; y <= extent.last[1]; y += 2)
      for (int x = 0; x <= extent.last[0]; x += 2)
        points[extent.at(x, y, z)] = coarser.values[coarser.at(std::min((box.low[0] + x) / 2, end[0] - 1),
                                                               std::min((box.low[1] + y) / 2, end[1] - 1),
                                                               std::min((box.low[2] + z) / 2, end[2] - 1))];
  std::vector<Sample> wanted(extent.samples());
  copy_texels(box, sizeof(Sample), samples.box, std::as_bytes(std::span(samples.values)), box,
              std::as_writable_bytes(std::span(wanted)));

  CodedBlock block;
  if (level == 0) note_range<Sample>(wanted, block.entry);
  block.entry.quantum = quantum_;
  auto bytes = coded_block<Sample>(extent, {options_.prediction, quantum_}, wanted, options_.effort, points);
  if (!bytes) {
    block.entry.quantum = 0;
    bytes = coded_block<Sample>(extent, {options_.prediction, 0}, wanted, options_.effort, points);
  }
  block.bytes = *std::move(bytes);
  block.entry.coarser_error = distance_from_interpolation<Sample>(extent, points);
  const std::vector<Sample> read = samples_inside<Sample>(extent, points);
  copy_texels(box, sizeof(Sample), box, std::as_bytes(std::span(read)), samples.box,
              std::as_writable_bytes(std::span(samples.values)));
  return block;
}

template <typename Sample>
void HierarchyWriter<Sample>::write_blocks(int level, const Samples<Sample>& coarser, std::array<int, 2> slices,
                                           Samples<Sample>& samples) {
  TexelBox box = samples.box;
  box.low[2] = slices[0];
  box.high[2] = slices[1];
  std::vector<BlockPlace> places;
  for_each_block(blocks_around(box), [&](const BlockPlace& place) { places.push_back(place); });
  std::vector<CodedBlock> coded_blocks(places.size());
  tbb::parallel_for(std::size_t{0}, places.size(),
                    [&](std::size_t i) { coded_blocks[i] = coded(level, places[i], coarser, samples); });
  for (std::size_t i = 0; i < places.size(); ++i) {
    HierarchicalBlock& entry = blocks_[grid_.number_of(level, places[i])];
    entry = coded_blocks[i].entry;
    entry.offset = file_.size();
    entry.bytes = std::uint32_t(coded_blocks[i].bytes.size());
    file_.append(coded_blocks[i].bytes);
  }
}

/// Ranges cover the volume's own scalars.
template <typename Sample>
void HierarchyWriter<Sample>::gather_ranges() {
  for (int level = 0; level < grid_.coarsest(); ++level)
    for_each_block({{0, 0, 0}, grid_.blocks(level)}, [&](const BlockPlace& place) {
      const HierarchicalBlock& entry = blocks_[grid_.number_of(level, place)];
      HierarchicalBlock& above =
          blocks_[grid_.number_of(level + 1, {place[0] / 2, place[1] / 2, place[2] / 2})];
      if (!(entry.low <= entry.high)) return;
      above.low = above.low <= above.high ? std::min(above.low, entry.low) : entry.low;
      above.high = std::max(above.high, entry.high);
    });
}

template <typename Sample>
double HierarchyWriter<Sample>::largest_error_of(int level, TexelBox blocks,
                                                 std::span<const double> errors) const {
  const std::array<int, 3> end = grid_.blocks(level);
  for (std::size_t k = 0; k < 3; ++k) blocks.high[k] = std::min(blocks.high[k], end[k]);
  double most = 0;
  for_each_block(
      blocks, [&](const BlockPlace& place) { most = std::max(most, errors[grid_.number_of(level, place)]); });
  return most;
}

/// Errors add up from level to level. Between two levels, both interpolations are trilinear on each cell of the
/// finer one, so the corners of the cells bound their difference; some of these corners are samples of the next
/// blocks.
template <typename Sample>
void HierarchyWriter<Sample>::gather_errors() {
  const HierarchicalBlock& all = blocks_.front();
  // Interpolated values lie within the range of the volume's own.
  const double range = all.low <= all.high ? all.high - all.low + error_of<Sample>(quantum_) : 0;
  std::vector<double> between_levels(blocks_.size());
  std::vector<double> errors(blocks_.size());
  for (std::size_t i = 0; i < blocks_.size(); ++i) between_levels[i] = blocks_[i].coarser_error;
  for (int level = 0; level < grid_.coarsest(); ++level)
    for_each_block({{0, 0, 0}, grid_.blocks(level)}, [&](const BlockPlace& place) {
      const auto [x, y, z] = place;
      const std::size_t number = grid_.number_of(level, place);
      errors[number] =
          level == 0 ? between_levels[number] + error_of<Sample>(quantum_)
                     : largest_error_of(level, {place, {x + 2, y + 2, z + 2}}, between_levels) +
                           largest_error_of(level - 1,
                                            {{2 * x, 2 * y, 2 * z}, {2 * x + 2, 2 * y + 2, 2 * z + 2}}, errors);
      blocks_[number].coarser_error =
          std::isfinite(errors[number]) ? std::min(errors[number], range) : errors[number];
    });
}

template <typename Sample>
HierarchyFigures HierarchyWriter<Sample>::figures() const {
  const FileDescription& description = volume_.description();
  HierarchyFigures figures;
  figures.scalar_bytes = texels_in({{0, 0, 0}, grid_.size(0)}) * sizeof(Sample);
  figures.file_bytes = file_.size();
  for (int level = 0; level < grid_.levels(); ++level) {
    HierarchyFigures::Level& of = figures.levels.emplace_back();
    of.size = grid_.size(level);
    for (std::size_t number = grid_.first_of(level); number < grid_.first_of(level - 1); ++number)
      of.bytes += blocks_[number].bytes;
    if (level == 0) {
      of.error = error_of<Sample>(quantum_);
    } else {
      for (std::size_t number = grid_.first_of(level - 1); number < grid_.first_of(level - 2); ++number)
        of.error = std::max(of.error, blocks_[number].coarser_error);
    }
    of.error *= std::abs(description.scale);
  }
  return figures;
}

template <typename Sample>
HierarchyFigures HierarchyWriter<Sample>::write() {
  constexpr double reading = 0.15;  // fraction of the work
  const std::vector<std::byte> no_blocks_yet(std::size_t(blocks_begin(grid_)));
  file_.append(no_blocks_yet);
  const int depth = grid_.size(0)[2];
  if (grid_.coarsest() == 0) {
    const Samples<Sample> all = slices(0, depth, 1);
    note_range<Sample>(all.values, blocks_.front());
    write_coarsest(all);
  } else {
    std::vector<Samples<Sample>> levels;  // from level 1 on
    levels.emplace_back(TexelBox{{0, 0, 0}, grid_.size(1)});
    for (const auto& [low, high] : layers(depth)) {
      const Samples<Sample> some = slices(low, high, 2);
      for (int z = some.box.low[2]; z < some.box.high[2]; ++z)
        for (int y = 0; y < levels[0].box.high[1]; ++y)
          for (int x = 0; x < levels[0].box.high[0]; ++x)
            levels[0].values[levels[0].at(x, y, z)] = some.values[some.at(2 * x, 2 * y, z)];
      report(reading * low / depth);
    }
    for (int level = 2; level <= grid_.coarsest(); ++level) levels.push_back(every_second(levels.back()));
    write_coarsest(levels.back());
    for (int level = grid_.coarsest() - 1; level > 0; --level)
      for (const auto& some : layers(grid_.size(level)[2]))
        write_blocks(level, levels[std::size_t(level)], some, levels[std::size_t(level) - 1]);
    for (const auto& [low, high] : layers(depth)) {
      Samples<Sample> some = slices(low, high, 1);
      write_blocks(0, levels[0], {low, high}, some);
      report(reading + (1 - reading) * low / depth);
    }
    gather_ranges();
    gather_errors();
  }
  file_.replace(hierarchical_header_bytes, table_bytes(blocks_));
  file_.replace(0, header_bytes({volume_.description(), options_.prediction, error_of<Sample>(quantum_)}));
  HierarchyFigures result = figures();
  file_.finish();
  report(1);
  return result;
}

}  // namespace

HierarchyFigures write_hierarchical(VolumeFile& volume, const std::string& path,
                                    const HierarchyOptions& options,
                                    const std::function<void(double)>& progress) {
  const ScalarType type = volume.description().type;
  HierarchyFigures figures;
  const bool held = with_sample_type(type, [&](auto sample) {
    figures = HierarchyWriter<decltype(sample)>(volume, path, options, progress).write();
  });
  if (!held)
    throw FileError(fmt::format("{}: cannot hold {} scalars; make them f32 or i32 first", path, name_of(type)));
  return figures;
}

}  // namespace understudy::volume
