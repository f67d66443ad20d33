// SPDX-License-Identifier: Apache-2.0
// A volume in a file, or in a folder of files with a slice each. Any box of it can be read without the rest.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "volume/file/byte_source.h"
#include "volume/file/readable_files.h"
#include "volume/file/scalar_type.h"
#include "volume/texel_box.h"
#include "volume/texture_space.h"

namespace understudy::volume {

/// User-supplied information about a file: properties that raw files lack, the level of hierarchical volumes,
/// the time step of files that contain several.
struct FileHints {
  std::optional<std::array<int, 3>> size;
  std::optional<ScalarType> type;
  std::optional<bool> big_endian;
  int level = 0;      ///< the level of a hierarchical volume to read; 0 is the finest
  int time_step = 0;  ///< the time step to read, counted from 0
  /// The channel of an image to read, counted from 0. Unset: the image has only one.
  std::optional<int> channel;

  bool operator==(const FileHints&) const = default;
};

/// Describes a coarser level of a hierarchical volume.
struct LevelOfDetail {
  int level = 0;
  std::array<int, 3> volume_size{};  ///< of the finest level
  /// Upper bound of the difference between the volume's values and the level's trilinear interpolation.
  double error = 0;
};

struct FileDescription {
  std::array<int, 3> size{};
  Vec3 spacing{1, 1, 1};                ///< between scalars, in any unit
  std::optional<LevelOfDetail> detail;  ///< set if this is a coarser level
  ScalarType type = ScalarType::u8;
  int time_steps = 1;  ///< in the file; all other members describe a single one
  int channels = 1;    ///< likewise
  /// A scalar s of the file has the value offset + scale * s.
  double scale = 1;
  double offset = 0;
  /// The volume's least and greatest value, if its file specifies them, there are any, and both are finite.
  std::optional<std::array<double, 2>> values;
};

class VolumeFile {
 public:
  explicit VolumeFile(const FileDescription& description) : description_(description) {}
  virtual ~VolumeFile() = default;

  const FileDescription& description() const { return description_; }

  /// Reads the scalars of `box`, tightly packed, x fastest, in native byte order. Boxes in the order of the
  /// file (x fastest, z slowest) are read in one pass, even from compressed files. Throws FileError.
  virtual void read(const TexelBox& box, std::span<std::byte> scalars) = 0;
  /// For compressed files, skips up to `most` of the bytes before `box`; returns true when none are left to
  /// skip. Throws FileError.
  virtual bool approach(const TexelBox& /*box*/, std::uint64_t /*most*/) { return true; }
  /// Bytes that are read for each scalar.
  virtual std::size_t bytes_for_scalar() const { return bytes_per_scalar(description_.type); }
  /// Bytes read from the file so far, including headers.
  virtual std::uint64_t bytes_read() const = 0;
  /// Bounds of the values in `box`, infinite ones included, if the file specifies them apart from its scalars;
  /// low > high: there are none.
  virtual std::optional<std::array<double, 2>> values_in(const TexelBox& /*box*/) const { return std::nullopt; }
  /// The most memory that read() takes, in addition to `scalars`, for this box or any like it further along z.
  virtual std::size_t memory_to_read(const TexelBox& /*box*/) const { return 0; }

 private:
  FileDescription description_;
};

/// Contiguous scalars of all time steps, x fastest, from `offset` of `bytes` on.
struct DenseScalars {
  std::unique_ptr<ByteSource> bytes;
  std::uint64_t offset = 0;
  bool at_end = false;          ///< they end a plain file, and begin at `offset` or later
  int time_step = 0;            ///< the one to read
  bool steps_together = false;  ///< time is the fastest axis: all time steps of a place are contiguous
  bool big_endian = false;
  bool nothing_follows = false;  ///< bytes after the last scalar are an error
  /// Advice for the case of too few or too many bytes.
  std::string advice;
};

/// Called last by the readers of formats. Checks the description's sizes, the time step, and the number of
/// bytes as far as it is known.
std::unique_ptr<VolumeFile> dense_volume(const FileDescription& description, DenseScalars scalars);

/// The bytes of all scalars. Throws FileError, naming `path`, if an axis is empty or longer than a volume
/// permits.
std::uint64_t checked_bytes(const std::array<std::int64_t, 3>& size, ScalarType type, const std::string& path);

/// Throws FileError, naming `path`, if a file cannot contain that many.
int checked_time_steps(std::int64_t steps, const std::string& path);

/// Throws FileError, naming `path`, unless `step` is one of `steps`, counted from 0.
void check_time_step(int step, int steps, const std::string& path);

/// The channel to read. Throws FileError, naming `path`, unless `chosen` is one of `channels`, counted from 0,
/// or there is only one.
int checked_channel(std::optional<int> chosen, std::int64_t channels, const std::string& path);

/// The magnitude of `spacing` if it is from 1e-30 to 1e30, so that it can be squared; otherwise 1.
double believable_spacing(double spacing);

}  // namespace understudy::volume
