// SPDX-License-Identifier: Apache-2.0
#include "volume/file/texel_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "volume/brick/brick_store.h"
#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

double top_of(TexelType type) {
  return type == TexelType::f32 ? 1.0 : type == TexelType::u16 ? 65535.0 : 255.0;
}

TexelType natural_type(ScalarType type) {
  switch (type) {
    case ScalarType::u8:
    case ScalarType::i8:
      return TexelType::u8;
    case ScalarType::u16:
    case ScalarType::i16:
      return TexelType::u16;
    default:
      return TexelType::f32;
  }
}

/// The least and the greatest scalar of an integer type that has no more bits than texels.
std::optional<std::array<double, 2>> whole_range(ScalarType type) {
  switch (type) {
    case ScalarType::u8:
      return std::array{0.0, 255.0};
    case ScalarType::i8:
      return std::array{-128.0, 127.0};
    case ScalarType::u16:
      return std::array{0.0, 65535.0};
    case ScalarType::i16:
      return std::array{-32768.0, 32767.0};
    default:
      return std::nullopt;
  }
}

}  // namespace

double TexelMapping::normalised(double value) const {
  return (value - offset) / (scale * top_of(type));
}

TexelMapping mapping_of(const FileDescription& file, const TexelChoice& choice) {
  TexelMapping mapping;
  mapping.type = choice.type.value_or(
      choice.range && natural_type(file.type) == TexelType::f32 ? TexelType::u16 : natural_type(file.type));
  if (mapping.type == TexelType::rgba8)
    throw FileError("a volume of scalars has no colours; choose u8, u16 or f32");
  if (mapping.type == TexelType::f32) return mapping;  // floats are values
  const std::optional<std::array<double, 2>> whole = whole_range(file.type);
  if (!choice.range && whole && mapping.type == natural_type(file.type)) {  // the scalars themselves
    mapping.scale = file.scale;
    mapping.offset = file.offset + file.scale * (*whole)[0];
    return mapping;
  }
  if (!choice.range && !whole)
    throw FileError(fmt::format(
        "scalars of type {} have no range of their own that would fit into fewer bits; give the least "
        "and the greatest value (--range LOW,HIGH)",
        name_of(file.type)));
  const std::array<double, 2> range =
      choice.range ? *choice.range
                   : std::array{file.offset + file.scale * (*whole)[0], file.offset + file.scale * (*whole)[1]};
  if (!std::isfinite(range[0]) || !std::isfinite(range[1]) || range[0] == range[1] ||
      (choice.range && range[0] > range[1]))
    throw FileError(
        fmt::format("the range {} to {} holds no values; give the least one first", range[0], range[1]));
  mapping.offset = range[0];
  mapping.scale = (range[1] - range[0]) / top_of(mapping.type);
  return mapping;
}

TexelStream::TexelStream(std::unique_ptr<VolumeFile> file, const TexelChoice& choice, const TexelBox& box)
    : file_(std::move(file)),
      mapping_(mapping_of(file_->description(), choice)),
      box_(box),
      next_z_(box.low[2]) {
  if (is_empty(box_)) next_z_ = box_.high[2];
  figures_.low = std::numeric_limits<double>::infinity();
  figures_.high = -figures_.low;
}

std::uint64_t TexelStream::texels_in_all() const {
  return texels_in(box_);
}

std::uint64_t TexelStream::texels_done() const {
  TexelBox done = box_;
  done.high[2] = next_z_;
  return texels_in(done);
}

TexelBox TexelStream::next_slice() const {
  TexelBox slice = box_;
  slice.low[2] = next_z_;
  slice.high[2] = next_z_ + 1;
  return slice;
}

bool TexelStream::approach(std::uint64_t max_bytes) {
  return done() || file_->approach(next_slice(), max_bytes);
}

TexelStream::SliceSegment TexelStream::next(std::size_t max_bytes) {
  const std::size_t scalar = bytes_per_scalar(file_->description().type);
  SliceSegment slice_range{next_slice(), {}};
  const std::size_t slice = texels_in(slice_range.box);
  const std::size_t slices = std::max<std::size_t>(1, max_bytes / (slice * file_->bytes_for_scalar()));
  slice_range.box.high[2] = int(std::min<std::size_t>(std::size_t(box_.high[2] - next_z_), slices)) + next_z_;
  const std::size_t count = texels_in(slice_range.box);
  scalars_.resize(count * scalar);
  file_->read(slice_range.box, scalars_);
  texels_.resize(count * bytes_per_texel(mapping_.type));
  switch (file_->description().type) {
    case ScalarType::u8:
      convert<std::uint8_t>(scalars_);
      break;
    case ScalarType::i8:
      convert<std::int8_t>(scalars_);
      break;
    case ScalarType::u16:
      convert<std::uint16_t>(scalars_);
      break;
    case ScalarType::i16:
      convert<std::int16_t>(scalars_);
      break;
    case ScalarType::u32:
      convert<std::uint32_t>(scalars_);
      break;
    case ScalarType::i32:
      convert<std::int32_t>(scalars_);
      break;
    case ScalarType::u64:
      convert<std::uint64_t>(scalars_);
      break;
    case ScalarType::i64:
      convert<std::int64_t>(scalars_);
      break;
    case ScalarType::f32:
      convert<float>(scalars_);
      break;
    case ScalarType::f64:
      convert<double>(scalars_);
      break;
  }
  next_z_ = slice_range.box.high[2];
  if (done()) scalars_ = {};
  slice_range.texels = texels_;
  return slice_range;
}

template <typename Scalar>
void TexelStream::convert(std::span<const std::byte> scalars) {
  if (mapping_.type == TexelType::f32)
    convert_to<Scalar, float>(scalars);
  else if (mapping_.type == TexelType::u16)
    convert_to<Scalar, std::uint16_t>(scalars);
  else
    convert_to<Scalar, std::uint8_t>(scalars);
}

template <typename Scalar, typename Texel>
void TexelStream::convert_to(std::span<const std::byte> scalars) {
  const std::size_t count = scalars.size() / sizeof(Scalar);
  const FileDescription& file = file_->description();
  if constexpr (std::is_same_v<Scalar, Texel> && !std::is_same_v<Texel, float>) {
    // Copies the scalars if texels are the same as the file's scalars.
    if (mapping_.scale == file.scale && mapping_.offset == file.offset) {
      std::memcpy(texels_.data(), scalars.data(), scalars.size());
      Texel low = std::numeric_limits<Texel>::max(), high = 0;
      for (std::size_t i = 0; i < count; ++i) {
        Texel texel;
        std::memcpy(&texel, scalars.data() + i * sizeof texel, sizeof texel);
        low = std::min(low, texel);
        high = std::max(high, texel);
      }
      const double a = file.offset + file.scale * low, b = file.offset + file.scale * high;
      figures_.low = std::min({figures_.low, a, b});
      figures_.high = std::max({figures_.high, a, b});
      return;
    }
  }
  constexpr double largest = BrickStore::largest_value;
  double low = figures_.low, high = figures_.high, error = figures_.largest_error;
  for (std::size_t i = 0; i < count; ++i) {
    Scalar scalar;
    std::memcpy(&scalar, scalars.data() + i * sizeof scalar, sizeof scalar);
    const double value = file.offset + file.scale * double(scalar);
    Texel texel{};
    double meant = 0;
    if constexpr (std::is_same_v<Texel, float>) {
      texel = float(std::clamp(value, -largest, largest));  // NaN stays NaN
      meant = double(texel);
    } else {
      const double place = (value - mapping_.offset) / mapping_.scale;
      constexpr double top = std::numeric_limits<Texel>::max();
      texel = place > 0 ? Texel(std::lround(std::min(place, top))) : Texel(0);
      meant = mapping_.offset + mapping_.scale * double(texel);
    }
    std::memcpy(texels_.data() + i * sizeof texel, &texel, sizeof texel);
    if (std::isnan(value)) {
      ++figures_.not_numbers;
      continue;
    }
    error = std::max(error, std::abs(value - meant));
    // No transfer function can span infinite values; they show what its ends show.
    if (std::isinf(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  figures_.low = low;
  figures_.high = high;
  figures_.largest_error = error;
}

}  // namespace understudy::volume
