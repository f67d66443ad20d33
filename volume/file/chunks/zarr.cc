// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/zarr.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <ranges>
#include <utility>
#include <vector>

#include "volume/file/chunks/chunk_files.h"
#include "volume/file/chunks/zarr_array.h"
#include "volume/file/chunks/zarr_image.h"
#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

using Index = std::array<int, 3>;  ///< of a chunk, x first

/// One axis of the volume in the array, or one that the array does not have.
struct ChunkedAxis {
  std::int64_t length = 1;
  std::int64_t chunk = 1;
  std::size_t stride = 0;  ///< in a decoded chunk, in scalars
  std::size_t number = 0;  ///< among those of the array
  bool there = false;
};

class ZarrVolume : public VolumeFile {
 public:
  ZarrVolume(const FileDescription& description, const ZarrImage& image, ChunkFiles chunks,
             std::int64_t time_step, std::int64_t channel)
      : VolumeFile(description), chunks_(std::move(chunks)), fixed_(array().shape.size()) {
    std::vector<std::size_t> strides(array().shape.size());
    std::size_t stride = 1;
    for (const std::size_t axis : array().encoding.order | std::views::reverse) {
      strides[axis] = stride;
      stride *= std::size_t(array().chunks[axis]);
    }
    for (std::size_t axis = 0; axis < image.axes.size(); ++axis) {
      const ZarrAxis kind = image.axes[axis];
      if (kind >= ZarrAxis::z) {
        axes_[std::size_t(ZarrAxis::x) - std::size_t(kind)] = {array().shape[axis], array().chunks[axis],
                                                               strides[axis], axis, true};
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
      // Those of the layers before are not asked for again.
      std::erase_if(decoded_, [&](const auto& entry) { return entry.first[2] < z; });
      for (int y = low[1]; y < high[1]; ++y)
        for (int x = low[0]; x < high[0]; ++x) copy_chunk({x, y, z}, box, scalars);
    }
  }

  std::uint64_t bytes_read() const override { return chunks_.bytes_read(); }
  std::size_t memory_to_read(const TexelBox& box) const override {
    // Those of one layer.
    std::size_t chunks = 1;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::int64_t in_all = (axes_[k].length + axes_[k].chunk - 1) / axes_[k].chunk;
      chunks *= std::size_t(std::min<std::int64_t>(in_all, (box.high[k] - box.low[k]) / axes_[k].chunk + 2));
    }
    constexpr std::size_t entry_bytes = 128;
    return chunks * (chunks_.decoded_bytes() + entry_bytes) + chunks_.memory_to_read();
  }

 private:
  std::size_t scalar_bytes() const { return bytes_per_scalar(description().type); }

  const ZarrArray& array() const { return chunks_.array(); }

  const std::vector<std::byte>& decoded(const Index& chunk) {
    const auto found = decoded_.find(chunk);
    if (found != decoded_.end()) return found->second;
    std::vector<std::int64_t> numbers = fixed_;
    for (std::size_t k = 0; k < 3; ++k)
      if (axes_[k].there) numbers[axes_[k].number] = chunk[k];
    return decoded_.emplace(chunk, chunks_.scalars_of(numbers)).first->second;
  }

  /// What of the chunk lies in `box`.
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
  std::vector<std::int64_t> fixed_;  ///< numbers of the chunk along the array's other axes
  std::size_t first_ = 0;            ///< where in a chunk the time step and the channel begin, in scalars
  std::map<Index, std::vector<std::byte>> decoded_;
};

void check_files(const ZarrArray& array, const std::string& folder) {
  constexpr double least_scalars = 512, most_files = 1 << 20;
  double files = 1, scalars = 1;
  for (std::size_t axis = 0; axis < array.shape.size(); ++axis) {
    const double length = double(array.chunks[axis]) * (array.shards ? double(array.shards->chunks[axis]) : 1);
    files *= double(array.shape[axis]) / length;
    scalars *= length;
  }
  if (scalars < least_scalars && files > most_files)
    throw FileError(fmt::format("{}: Zarr: it has {:.0f} files of {} scalars; write larger chunks", folder,
                                files, scalars));
}

void check_axes(const ZarrImage& image, const ZarrArray& array, const std::string& folder) {
  std::vector<ZarrAxis> sorted = image.axes;
  std::ranges::sort(sorted);
  const bool twice = std::ranges::adjacent_find(sorted) != sorted.end();
  if (image.axes.size() != array.shape.size() || twice ||
      std::ranges::find(sorted, ZarrAxis::x) == sorted.end())
    throw FileError(fmt::format("{}: Zarr: its array has {} axes, of which {} are told; check its metadata",
                                folder, array.shape.size(), image.axes.size()));
}

}  // namespace

std::unique_ptr<VolumeFile> open_zarr(const std::string& folder, const FileHints& hints,
                                      const ReadableFiles& files) {
  const ZarrImage image = zarr_image(folder, hints.level, files);
  ZarrArray array = zarr_array(image.folder, files);
  check_axes(image, array, folder);
  check_files(array, folder);
  std::array<std::int64_t, 3> size{1, 1, 1};
  std::int64_t steps = 1, channels = 1;
  for (std::size_t axis = 0; axis < image.axes.size(); ++axis) {
    const ZarrAxis kind = image.axes[axis];
    if (kind == ZarrAxis::time)
      steps = array.shape[axis];
    else if (kind == ZarrAxis::channel)
      channels = array.shape[axis];
    else
      size[std::size_t(ZarrAxis::x) - std::size_t(kind)] = array.shape[axis];
  }
  FileDescription description;
  checked_bytes(size, array.type, folder);
  std::ranges::transform(size, description.size.begin(), [](std::int64_t length) { return int(length); });
  description.spacing = image.spacing;
  description.type = array.type;
  description.time_steps = checked_time_steps(steps, folder);
  description.channels = int(channels);
  check_time_step(hints.time_step, description.time_steps, folder);
  const int channel = checked_channel(hints.channel, channels, folder);
  return std::make_unique<ZarrVolume>(description, image, ChunkFiles(image.folder, std::move(array), files),
                                      hints.time_step, channel);
}

}  // namespace understudy::volume
