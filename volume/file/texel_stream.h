// SPDX-License-Identifier: Apache-2.0
// A box of a volume file as texels, slice range by slice range: what a rank reads of a volume is its own box
// and nothing else.
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

/// What a texel means: the value offset + scale * texel, the texel in units of its type (u8: 0 to 255, u16: 0
/// to 65535, float: itself).
struct TexelMapping {
  TexelType type = TexelType::u8;
  double scale = 1;
  double offset = 0;

  /// The texel of a value, normalised as transfer functions want it (u8: divided by 255).
  double normalised(double value) const;
};

/// How the scalars of a file become texels.
struct TexelChoice {
  /// None: u8 and i8 become u8, u16 and i16 become u16, both exactly; all others become f32, rounded.
  std::optional<TexelType> type;
  /// These values become the least and the greatest texel of u8 or u16, and what lies outside is clamped. None:
  /// the whole range of an integer type.
  std::optional<std::array<double, 2>> range;

  bool operator==(const TexelChoice&) const = default;
};

/// Throws FileError where the choice cannot be made (colours, an empty range, floats as u8 without a range).
TexelMapping mapping_of(const FileDescription& file, const TexelChoice& choice);

/// Of the texels that have come so far.
struct TexelFigures {
  double low = 0;  ///< least and greatest value; low > high when there was none
  double high = -1;
  double largest_error = 0;  ///< between a value and that of its texel
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

  /// Of a compressed file, passes over up to `max_bytes` of those before the next slices; true: none are left.
  /// So next() can be kept from passing over all of them at once. Throws FileError.
  bool approach(std::uint64_t max_bytes);

  struct SliceSegment {
    TexelBox box;
    std::span<const std::byte> texels;  ///< valid until the next call
  };
  /// The next slices of the box: as many as `max_bytes` of the file's scalars hold, one at least. Throws
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
