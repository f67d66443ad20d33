// SPDX-License-Identifier: Apache-2.0
// A volume in a file, of which any box can be read without the rest, or in a folder of files with a slice each.
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

/// What the user says about a file: of raw files what these do not say themselves, of hierarchical ones the
/// level, of files of several time steps which one.
struct FileHints {
  std::optional<std::array<int, 3>> size;
  std::optional<ScalarType> type;
  std::optional<bool> big_endian;
  int level = 0;      ///< of a hierarchical volume: which of its levels is read; 0 is the finest
  int time_step = 0;  ///< which of those that the file holds is read, counted from 0
  /// Of an image with several channels: which is read, counted from 0. None: it has one.
  std::optional<int> channel;

  bool operator==(const FileHints&) const = default;
};

/// What a coarser level of a hierarchical volume is of.
struct LevelOfDetail {
  int level = 0;
  std::array<int, 3> volume_size{};  ///< of the finest level
  /// No value of the volume lies farther from what the level gives there by trilinear interpolation.
  double error = 0;
};

struct FileDescription {
  std::array<int, 3> size{};
  Vec3 spacing{1, 1, 1};                ///< between scalars, in any unit
  std::optional<LevelOfDetail> detail;  ///< where this is a coarser level
  ScalarType type = ScalarType::u8;
  int time_steps = 1;  ///< that the file holds; all else is said of each of them
  int channels = 1;    ///< likewise
  /// A scalar s of the file means the value offset + scale * s.
  double scale = 1;
  double offset = 0;
  /// The volume's least and greatest value, where its file tells them and there are any.
  std::optional<std::array<double, 2>> values;
};

class VolumeFile {
 public:
  explicit VolumeFile(const FileDescription& description) : description_(description) {}
  virtual ~VolumeFile() = default;

  const FileDescription& description() const { return description_; }

  /// The scalars of `box`, tightly packed, x fastest, in native byte order. Boxes in the order of the file (x
  /// fastest, z slowest) are read in one pass, also from compressed files. Throws FileError.
  virtual void read(const TexelBox& box, std::span<std::byte> scalars) = 0;
  /// Of a compressed file, passes over up to `most` of the bytes before `box`; true: none are left to pass.
  /// Throws FileError.
  virtual bool approach(const TexelBox& /*box*/, std::uint64_t /*most*/) { return true; }
  /// Bytes that are read for each scalar.
  virtual std::size_t bytes_for_scalar() const { return bytes_per_scalar(description_.type); }
  /// What has been read of the file so far, headers included.
  virtual std::uint64_t bytes_read() const = 0;
  /// Values between which those of `box` lie, as far as the file tells them without its scalars; low > high:
  /// there are none.
  virtual std::optional<std::array<double, 2>> values_in(const TexelBox& /*box*/) const { return std::nullopt; }
  /// The memory that read() takes at most for a box as this one anywhere behind it along z, beside `scalars`.
  virtual std::size_t memory_to_read(const TexelBox& /*box*/) const { return 0; }

 private:
  FileDescription description_;
};

/// Scalars that lie one after the other, x fastest, from `offset` of `bytes` on: those of all time steps.
struct DenseScalars {
  std::unique_ptr<ByteSource> bytes;
  std::uint64_t offset = 0;
  bool at_end = false;          ///< they are what a plain file ends with, and begin no earlier than at `offset`
  int time_step = 0;            ///< which is read
  bool steps_together = false;  ///< time is the fastest axis: all steps of a place lie together, then the next
  bool big_endian = false;
  bool nothing_follows = false;  ///< bytes behind the last scalar are an error
  /// What to try when there are too few bytes or too many.
  std::string advice;
};

/// What a format's reader ends in. Checks the description's sizes, the time step, and as far as it is known the
/// number of bytes.
std::unique_ptr<VolumeFile> dense_volume(const FileDescription& description, DenseScalars scalars);

/// The bytes of all scalars. Throws FileError, naming `path`, when an axis is empty or longer than a volume can
/// be.
std::uint64_t checked_bytes(const std::array<std::int64_t, 3>& size, ScalarType type, const std::string& path);

/// Throws FileError, naming `path`, where a file cannot hold so many.
int checked_time_steps(std::int64_t steps, const std::string& path);

/// Throws FileError, naming `path`, unless `step` is one of `steps`, counted from 0.
void check_time_step(int step, int steps, const std::string& path);

/// The channel that is read. Throws FileError, naming `path`, unless `chosen` is one of `channels`, counted
/// from 0, or there is one only.
int checked_channel(std::optional<int> chosen, std::int64_t channels, const std::string& path);

/// What may stand between two scalars: anything but a positive finite number that can be squared becomes 1.
double believable_spacing(double spacing);

}  // namespace understudy::volume
