// SPDX-License-Identifier: Apache-2.0
// Reads a box of a volume file as texels, slice range by slice range. A rank reads only its own box.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "volume/file/volume_file.h"
#include "volume/texel_box.h"
#include "volume/texel_type.h"

namespace understudy::volume {

/// The value of a texel is offset + scale * texel, with the texel in units of its type (u8: 0 to 255, u16: 0 to
/// 65535, float: itself).
struct TexelMapping {
  TexelType type = TexelType::u8;
  double scale = 1;
  double offset = 0;

  /// The texel of a value, normalised as for transfer functions (u8: divided by 255).
  double normalised(double value) const;
};

/// How the scalars of a file are converted to texels.
struct TexelChoice {
  /// Unset: u8 and i8 become u8, u16 and i16 become u16, both exactly; all others become f32, rounded.
  std::optional<TexelType> type;
  /// Maps these values to the least and the greatest texel of u8 or u16, and clamps values outside. Unset: the
  /// whole range of an integer type.
  std::optional<std::array<double, 2>> range;

  bool operator==(const TexelChoice&) const = default;
};

/// Throws FileError for an impossible choice (colours, an empty range, floats as u8 without a range).
TexelMapping mapping_of(const FileDescription& file, const TexelChoice& choice);

/// Statistics of the texels converted so far.
struct TexelFigures {
  double low = 0;  ///< least and greatest finite value; low > high if there was none
  double high = -1;
  double largest_error = 0;  ///< between a value and the value of its texel; infinite if some value is
  std::uint64_t not_numbers = 0;
};

class TexelStream {
 public:
  /// Reads `box` of the file. Throws FileError.
  TexelStream(std::unique_ptr<VolumeFile> file, const TexelChoice& choice, const TexelBox& box);

  const TexelMapping& mapping() const { return mapping_; }
  bool done() const { return next_z_ >= box_.high[2]; }
  std::uint64_t texels_done() const;
  std::uint64_t texels_in_all() const;
  std::uint64_t bytes_read() const { return file_->bytes_read(); }
  const TexelFigures& figures() const { return figures_; }

  /// For compressed files, skips up to `max_bytes` of the bytes before the next slices; returns true when none
  /// are left. Prevents next() from skipping all of them at once. Throws FileError.
  bool approach(std::uint64_t max_bytes);

  struct SliceSegment {
    TexelBox box;
    std::span<const std::byte> texels;  ///< valid until the next call
  };
  /// The next slices of the box: as many as fit into `max_bytes` of the file's scalars, at least one. Throws
  /// FileError.
  SliceSegment next(std::size_t max_bytes);

 private:
  TexelBox next_slice() const;
  template <typename Scalar>
  void convert(std::span<const std::byte> scalars);
  template <typename Scalar, typename Texel>
  void convert_to(std::span<const std::byte> scalars);

  std::unique_ptr<VolumeFile> file_;
  TexelMapping mapping_;
  TexelBox box_;
  int next_z_;
  std::vector<std::byte> scalars_;
  std::vector<std::byte> texels_;
  TexelFigures figures_;
};

}  // namespace understudy::volume
