// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/zarr.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "volume/file/chunks/chunk_files.h"
#include "volume/file/chunks/zarr_array.h"
#include "volume/file/chunks/zarr_image.h"
#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

using Index = std::array<int, 3>;  ///< of a chunk, x first

/// One axis of the volume in the array, or one that the array lacks.
struct ChunkedAxis {
  std::int64_t length = 1;
  std::int64_t chunk = 1;
  std::size_t stride = 0;  ///< in a decoded chunk, in scalars
  std::size_t number = 0;  ///< its index among the array's axes
  bool there = false;
};

class ZarrVolume : public VolumeFile {
 public:
  ZarrVolume(const FileDescription& description, const ZarrImage& image, ChunkFiles chunks,
             std::int64_t time_step, std::int64_t channel)
      : VolumeFile(description), chunks_(std::move(chunks)), fixed_(array().shape.size()) {
    std::vector<std::size_t> strides(array().shape.size());
    std::size_t stride = 1;
    const std::vector<std::size_t>& order = array().encoding.order;
    for (auto axis = order.rbegin(); axis != order.rend(); ++axis) {
      strides[*axis] = stride;
      stride *= std::size_t(array().chunks[*axis]);
    }
    for (std::size_t axis = 0; axis < image.axes.size(); ++axis) {
      const ZarrAxis kind = image.axes[axis];
      if (kind >= ZarrAxis::z) {
        axes_[volume_axis(kind)] = {array().shape[axis], array().chunks[axis], strides[axis], axis, true};
        continue;
      }
      const std::int64_t chosen = kind == ZarrAxis::time ? time_step : channel;
      fixed_[axis] = chosen / array().chunks[axis];
      first_ += std::size_t(chosen % array().chunks[axis]) * strides[axis];
    }
  }

  void read(const TexelBox& box, std::span<std::byte> scalars) override {
    if (!contains({{0, 0, 0}, description().size}, box) || scalars.size() != texels_in(box) * scalar_bytes())
      throw FileError(fmt::format("{}: a part was asked for that the volume does not have", chunks_.folder()));
    if (is_empty(box)) return;
    Index low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = int(box.low[k] / axes_[k].chunk);
      high[k] = int((box.high[k] - 1) / axes_[k].chunk) + 1;
    }
    for (int z = low[2]; z < high[2]; ++z) {
      // Chunks of previous layers are not needed again.
      std::erase_if(decoded_, [&](const auto& entry) { return entry.first[2] < z; });
      for (int y = low[1]; y < high[1]; ++y)
        for (int x = low[0]; x < high[0]; ++x) copy_chunk({x, y, z}, box, scalars);
    }
  }

  std::uint64_t bytes_read() const override { return chunks_.bytes_read(); }
  std::size_t memory_to_read(const TexelBox& box) const override {
    // Chunks of one layer, and the indices of all shards.
    std::size_t chunks = 1, shards = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t in_shard =
          array().shards && axes_[k].there ? array().shards->chunks[axes_[k].number] : 1;
      const std::size_t across = parts_across(box, k, axes_[k].chunk);
      if (k < 2) chunks *= across;
      shards *= parts_across(box, k, axes_[k].chunk * in_shard);
    }
    constexpr std::size_t entry_bytes = 128;
    return chunks * (chunks_.decoded_bytes() + entry_bytes) + chunks_.memory_to_read(shards);
  }

 private:
  std::size_t scalar_bytes() const { return bytes_per_scalar(description().type); }

  const ZarrArray& array() const { return chunks_.array(); }

  /// Upper bound of the number of parts of `length` that a box of this extent intersects, wherever it begins.
  std::size_t parts_across(const TexelBox& box, std::size_t k, std::int64_t length) const {
    const std::int64_t in_all = (axes_[k].length + length - 1) / length;
    return std::size_t(std::min<std::int64_t>(in_all, (box.high[k] - box.low[k]) / length + 2));
  }

  const std::vector<std::byte>& decoded(const Index& chunk) {
    const auto found = decoded_.find(chunk);
    if (found != decoded_.end()) return found->second;
    std::vector<std::int64_t> numbers = fixed_;
    for (std::size_t k = 0; k < 3; ++k)
      if (axes_[k].there) numbers[axes_[k].number] = chunk[k];
    return decoded_.emplace(chunk, chunks_.scalars_of(numbers)).first->second;
  }

  /// Copies the part of the chunk that lies in `box`.
  void copy_chunk(const Index& chunk, const TexelBox& box, std::span<std::byte> scalars) {
    const std::vector<std::byte>& from = decoded(chunk);
    const std::size_t bytes = scalar_bytes();
    std::array<std::int64_t, 3> low{}, high{}, origin{};
    for (std::size_t k = 0; k < 3; ++k) {
      origin[k] = chunk[k] * axes_[k].chunk;
      low[k] = std::max<std::int64_t>(box.low[k], origin[k]);
      high[k] = std::min<std::int64_t>(box.high[k], origin[k] + axes_[k].chunk);
    }
    const std::int64_t width = box.high[0] - box.low[0], height = box.high[1] - box.low[1];
    for (std::int64_t z = low[2]; z < high[2]; ++z)
      for (std::int64_t y = low[1]; y < high[1]; ++y) {
        const std::byte* source =
            from.data() + bytes * (first_ + std::size_t(low[0] - origin[0]) * axes_[0].stride +
                                   std::size_t(y - origin[1]) * axes_[1].stride +
                                   std::size_t(z - origin[2]) * axes_[2].stride);
        std::byte* to =
            scalars.data() +
            bytes * std::size_t(((z - box.low[2]) * height + y - box.low[1]) * width + low[0] - box.low[0]);
        for (std::int64_t x = low[0]; x < high[0]; ++x, to += bytes, source += bytes * axes_[0].stride)
          std::memcpy(to, source, bytes);
      }
  }

  ChunkFiles chunks_;
  std::array<ChunkedAxis, 3> axes_;
  std::vector<std::int64_t> fixed_;  ///< indices of the chunk along the array's other axes
  std::size_t first_ = 0;            ///< offset of the time step and the channel in a chunk, in scalars
  std::map<Index, std::vector<std::byte>> decoded_;
};

/// Checks the cost of reading the whole volume, for one time step and channel: chunks may contain others too,
/// and shard indices may have entries outside the array.
void check_work(const ZarrImage& image, const ZarrArray& array, const std::string& folder) {
  constexpr double most_small_chunks = 1 << 20, least_scalars = 512;
  constexpr double allowed_bytes = double(std::uint64_t(4) << 30), allowed_times = 64, index_entry_bytes = 16;
  double texels = 1, chunks = 1, scalars = 1, shards = 1;
  double decoded = double(bytes_per_scalar(array.element.type)), entries = 1;
  for (std::size_t axis = 0; axis < array.shape.size(); ++axis) {
    const double in_shard = array.shards ? double(array.shards->chunks[axis]) : 1;
    const double length = double(array.chunks[axis]);
    decoded *= length;
    entries *= in_shard;
    if (image.axes[axis] < ZarrAxis::z) continue;
    texels *= double(array.shape[axis]);
    scalars *= length;
    chunks *= std::ceil(double(array.shape[axis]) / length);
    shards *= std::ceil(double(array.shape[axis]) / (length * in_shard));
  }
  if (scalars < least_scalars && chunks > most_small_chunks)
    throw FileError(fmt::format("{}: Zarr: it has {:.0f} chunks of {} scalars; write larger ones", folder,
                                chunks, scalars));
  const double bytes = chunks * decoded + (array.shards ? shards * entries * index_entry_bytes : 0);
  if (bytes > std::max(allowed_bytes, allowed_times * texels * double(bytes_per_scalar(array.element.type))))
    throw FileError(
        fmt::format("{}: Zarr: to read {:.0f} scalars takes {:.0f} MiB of chunks and indices; write chunks "
                    "and shards of fewer time steps and channels, no larger than the array",
                    folder, texels, bytes / (1 << 20)));
}

void check_axes(const ZarrImage& image, const ZarrArray& array, const std::string& folder) {
  const auto fail = [&](const std::string& what) {
    throw FileError(fmt::format("{}: Zarr: {}; check its metadata", folder, what));
  };
  if (image.axes.size() != array.shape.size())
    fail(fmt::format("its array has {} axes, and {} are told", array.shape.size(), image.axes.size()));
  std::vector<ZarrAxis> sorted = image.axes;
  std::ranges::sort(sorted);
  if (std::ranges::adjacent_find(sorted) != sorted.end()) fail("one of its axes is told twice");
  if (std::ranges::find(sorted, ZarrAxis::x) == sorted.end()) fail("it has no axis x");
}

}  // namespace

std::unique_ptr<VolumeFile> open_zarr(const std::string& folder, const FileHints& hints,
                                      const ReadableFiles& files) {
  const ZarrImage image = zarr_image(folder, hints.level, files);
  ZarrArray array = zarr_array(image.folder, files);
  check_axes(image, array, folder);
  check_work(image, array, folder);
  std::array<std::int64_t, 3> size{1, 1, 1};
  std::int64_t steps = 1, channels = 1;
  for (std::size_t axis = 0; axis < image.axes.size(); ++axis) {
    const ZarrAxis kind = image.axes[axis];
    if (kind == ZarrAxis::time)
      steps = array.shape[axis];
    else if (kind == ZarrAxis::channel)
      channels = array.shape[axis];
    else
      size[volume_axis(kind)] = array.shape[axis];
  }
  FileDescription description;
  constexpr std::int64_t longest = 16384;
  if (image.levels > hints.level + 1 && std::ranges::max(size) > longest)
    throw FileError(
        fmt::format("{}: Zarr: level {} has {} x {} x {} scalars, more than {} along an axis; take a "
                    "coarser one: --level {}",
                    folder, hints.level, size[0], size[1], size[2], longest, hints.level + 1));
  checked_bytes(size, array.element.type, folder);
  std::ranges::transform(size, description.size.begin(), [](std::int64_t length) { return int(length); });
  description.spacing = image.spacing;
  description.type = array.element.type;
  description.scale = image.scale;
  description.offset = image.offset;
  description.time_steps = checked_time_steps(steps, folder);
  description.channels = int(channels);
  check_time_step(hints.time_step, description.time_steps, folder);
  const int channel = checked_channel(hints.channel, channels, folder);
  return std::make_unique<ZarrVolume>(description, image, ChunkFiles(image.folder, std::move(array), files),
                                      hints.time_step, channel);
}

}  // namespace understudy::volume
