// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/zarr.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "volume/file/chunks/zarr_metadata.h"
#include "volume/file/file_error.h"
#include "volume/file/scalar_dispatch.h"

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
  ZarrVolume(const FileDescription& description, ZarrImage image, ZarrArray array, std::int64_t time_step,
             std::int64_t channel, ReadableFiles files)
      : VolumeFile(description), image_(std::move(image)), array_(std::move(array)), files_(std::move(files)) {
    std::vector<std::size_t> strides(array_.shape.size());
    std::size_t stride = 1;
    for (std::size_t i = 0; i < strides.size(); ++i) {
      const std::size_t axis = array_.first_axis_fastest ? i : strides.size() - 1 - i;
      strides[axis] = stride;
      stride *= std::size_t(array_.chunks[axis]);
    }
    chunk_scalars_ = stride;
    fixed_.resize(array_.shape.size());
    for (std::size_t axis = 0; axis < image_.axes.size(); ++axis) {
      const ZarrAxis kind = image_.axes[axis];
      if (kind >= ZarrAxis::z) {
        axes_[std::size_t(ZarrAxis::x) - std::size_t(kind)] = {array_.shape[axis], array_.chunks[axis],
                                                               strides[axis], axis, true};
        continue;
      }
      const std::int64_t chosen = kind == ZarrAxis::time ? time_step : channel;
      fixed_[axis] = chosen / array_.chunks[axis];
      first_ += std::size_t(chosen % array_.chunks[axis]) * strides[axis];
    }
  }

  void read(const TexelBox& box, std::span<std::byte> scalars) override {
    if (!contains({{0, 0, 0}, description().size}, box) || scalars.size() != texels_in(box) * scalar_bytes())
      throw FileError(fmt::format("{}: a part was asked for that the volume does not have", image_.folder));
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

  std::uint64_t bytes_read() const override { return bytes_read_; }
  std::size_t memory_to_read(const TexelBox& box) const override {
    // Those of one layer, and one as it is compressed.
    std::size_t chunks = 1;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::int64_t in_all = (axes_[k].length + axes_[k].chunk - 1) / axes_[k].chunk;
      chunks *= std::size_t(std::min<std::int64_t>(in_all, (box.high[k] - box.low[k]) / axes_[k].chunk + 2));
    }
    constexpr std::size_t entry_bytes = 128;
    return (chunks + 1) * (chunk_scalars_ * scalar_bytes() + entry_bytes);
  }

 private:
  std::size_t scalar_bytes() const { return bytes_per_scalar(description().type); }

  std::string name_of(const Index& chunk) const {
    std::vector<std::int64_t> numbers = fixed_;
    for (std::size_t k = 0; k < 3; ++k)
      if (axes_[k].there) numbers[axes_[k].number] = chunk[k];
    std::string name;
    for (const std::int64_t number : numbers) {
      if (!name.empty()) name += array_.separator;
      name += std::to_string(number);
    }
    return (std::filesystem::path(image_.folder) / name).string();
  }

  const std::vector<std::byte>& decoded(const Index& chunk) {
    const auto found = decoded_.find(chunk);
    return found != decoded_.end() ? found->second : decoded_.emplace(chunk, read_chunk(chunk)).first->second;
  }

  std::vector<std::byte> read_chunk(const Index& chunk) {
    std::vector<std::byte> scalars(chunk_scalars_ * scalar_bytes());
    const std::string path = name_of(chunk);
    const std::unique_ptr<ByteSource> file = open_file_if_there(path, files_);
    if (!file) {
      fill(scalars);
      return scalars;
    }
    // What is compressed may be a little longer than what it is of, and no more.
    const std::uint64_t bytes = file->size().value_or(0);
    if (bytes > 2 * scalars.size() + most_overhead)
      throw FileError(
          fmt::format("{}: Zarr: a chunk of {} bytes has {}; get it again", path, scalars.size(), bytes));
    std::vector<std::byte> packed(static_cast<std::size_t>(bytes));
    packed.resize(file->read(0, packed));
    bytes_read_ += packed.size();
    try {
      decode_chunk(array_.codec, packed, scalars);
    } catch (const std::runtime_error& error) {
      throw FileError(fmt::format("{}: Zarr: {}; get the file again", path, error.what()));
    }
    if (array_.big_endian != (std::endian::native == std::endian::big))
      for (std::size_t at = 0; at < scalars.size(); at += scalar_bytes())
        std::reverse(scalars.begin() + std::ptrdiff_t(at),
                     scalars.begin() + std::ptrdiff_t(at + scalar_bytes()));
    return scalars;
  }

  void fill(std::span<std::byte> scalars) const {
    const auto put = [&]<typename Scalar>(Scalar) {
      const Scalar value = as<Scalar>(array_.fill);
      for (std::size_t at = 0; at < scalars.size(); at += sizeof value)
        std::memcpy(scalars.data() + at, &value, sizeof value);
    };
    if (with_sample_type(description().type, put)) return;
    description().type == ScalarType::u64 ? put(std::uint64_t{}) : put(std::int64_t{});
  }

  /// 0 for values that an integer type does not have, and for those beyond 9.2e18.
  template <typename Scalar>
  static Scalar as(double value) {
    if constexpr (std::is_floating_point_v<Scalar>) return Scalar(value);
    constexpr double below = 9.2e18;  // what fits into 64 bits however it is rounded
    const bool fits = value >= std::max(-below, double(std::numeric_limits<Scalar>::min())) &&
                      value <= std::min(below, double(std::numeric_limits<Scalar>::max()));
    return fits ? Scalar(value) : Scalar(0);
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

  static constexpr std::size_t most_overhead = std::size_t(1) << 16;

  ZarrImage image_;
  ZarrArray array_;
  ReadableFiles files_;
  std::array<ChunkedAxis, 3> axes_;
  std::vector<std::int64_t> fixed_;  ///< numbers of the chunk along the array's other axes
  std::size_t first_ = 0;            ///< where in a chunk the time step and the channel begin, in scalars
  std::size_t chunk_scalars_ = 0;
  std::map<Index, std::vector<std::byte>> decoded_;
  std::uint64_t bytes_read_ = 0;
};

/// Each is a file of its own.
void check_chunks(const ZarrArray& array, const std::string& folder) {
  constexpr double least_scalars = 512, most_chunks = 1 << 20;
  double chunks = 1, scalars = 1;
  for (std::size_t axis = 0; axis < array.shape.size(); ++axis) {
    chunks *= double(array.shape[axis]) / double(array.chunks[axis]);
    scalars *= double(array.chunks[axis]);
  }
  if (scalars < least_scalars && chunks > most_chunks)
    throw FileError(fmt::format("{}: Zarr: it has {:.0f} chunks of {} scalars; write larger ones", folder,
                                chunks, scalars));
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
  ZarrImage image = zarr_image(folder, hints.level, files);
  ZarrArray array = zarr_array(image.folder, files);
  check_axes(image, array, folder);
  check_chunks(array, folder);
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
  return std::make_unique<ZarrVolume>(description, std::move(image), std::move(array), hints.time_step, channel,
                                      files);
}

}  // namespace understudy::volume
