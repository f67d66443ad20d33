// SPDX-License-Identifier: Apache-2.0
#include "volume/file/nifti.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <string_view>

#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

constexpr std::size_t header_bytes_1 = 348, header_bytes_2 = 540;
constexpr double largest_offset = 1e12;

[[noreturn]] void fail_nifti(const std::string& path, const std::string& what) {
  throw FileError(fmt::format("{}: not a readable NIfTI file: {}", path, what));
}

/// Reads fields of the header by their offset, in the byte order of its writer.
class NiftiHeader {
 public:
  explicit NiftiHeader(ByteSource& file) {
    got_ = file.read(0, bytes_);
    if (got_ < header_bytes_1)
      fail_nifti(file.path(), fmt::format("its header has only {} bytes; get the file again", got_));
    for (const bool foreign : {false, true}) {
      foreign_ = foreign;
      const auto size = at<std::int32_t>(0);
      if (size == std::int32_t(header_bytes_1)) version_ = 1;
      if (size == std::int32_t(header_bytes_2) && got_ == header_bytes_2) version_ = 2;
      if (version_ != 0) break;
    }
    if (version_ == 0)
      fail_nifti(file.path(),
                 "it does not begin with a header's length; get the file again, or give raw scalars another "
                 "name and their size");
    const char* magic = reinterpret_cast<const char*>(bytes_.data()) + (version_ == 1 ? 344 : 4);
    const char digit = version_ == 1 ? '1' : '2';
    if (magic[0] != 'n' || (magic[1] != '+' && magic[1] != 'i') || magic[2] != digit)
      fail_nifti(file.path(),
                 "it has no NIfTI mark (an ANALYZE file?); convert it, for example with `fslchfiletype NIFTI`");
    one_file_ = magic[1] == '+';
  }

  int version() const { return version_; }
  bool one_file() const { return one_file_; }
  bool big_endian() const { return foreign_ != (std::endian::native == std::endian::big); }

  template <typename T>
  T at(std::size_t offset) const {
    std::array<std::byte, sizeof(T)> raw{};
    std::copy_n(bytes_.begin() + std::ptrdiff_t(offset), sizeof(T), raw.begin());
    if (foreign_) std::ranges::reverse(raw);
    return std::bit_cast<T>(raw);
  }

 private:
  std::array<std::byte, header_bytes_2> bytes_{};
  std::size_t got_ = 0;
  int version_ = 0;
  bool foreign_ = false;
  bool one_file_ = false;
};

ScalarType type_of(int code, const std::string& path) {
  static const std::map<int, ScalarType> codes{
      {2, ScalarType::u8},     {4, ScalarType::i16},   {8, ScalarType::i32},   {16, ScalarType::f32},
      {64, ScalarType::f64},   {256, ScalarType::i8},  {512, ScalarType::u16}, {768, ScalarType::u32},
      {1024, ScalarType::i64}, {1280, ScalarType::u64}};
  const auto found = codes.find(code);
  if (found == codes.end())
    fail_nifti(
        path,
        fmt::format("its data of type {} is no scalar that can be drawn; extract one component first", code));
  return found->second;
}

/// "a.hdr.gz" for "a.img.gz", and vice versa.
std::string with_part(std::string path, std::string_view from, std::string_view to) {
  const std::size_t at = path.size() - (has_extension(path, ".gz") ? 3 : 0) - from.size();
  const bool capitals = path[at + 1] >= 'A' && path[at + 1] <= 'Z';
  std::string part(to);
  if (capitals)
    std::ranges::transform(part, part.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  return path.replace(at, from.size(), part);
}

bool is_part(const std::string& path, std::string_view extension) {
  return has_extension(path, extension) || has_extension(path, std::string(extension) + ".gz");
}

}  // namespace

bool is_nifti(const std::string& path) {
  return is_part(path, ".nii") || is_part(path, ".hdr") || is_part(path, ".img");
}

std::unique_ptr<VolumeFile> open_nifti(const std::string& path, int time_step, const ReadableFiles& files) {
  const std::string header_path = is_part(path, ".img") ? with_part(path, ".img", ".hdr") : path;
  std::unique_ptr<ByteSource> file = open_file_or_gzip(header_path, files);
  const NiftiHeader header(*file);

  // dim[0] is the number of axes, dim[1] ... their lengths.
  std::array<std::int64_t, 8> dim{};
  FileDescription description;
  double data_offset = 0, slope = 0, intercept = 0;
  int code = 0;
  for (std::size_t i = 0; i < dim.size(); ++i)
    dim[i] = header.version() == 1 ? header.at<std::int16_t>(40 + 2 * i) : header.at<std::int64_t>(16 + 8 * i);
  for (std::size_t i = 0; i < 3; ++i)
    description.spacing[i] = believable_spacing(header.version() == 1 ? double(header.at<float>(80 + 4 * i))
                                                                      : header.at<double>(112 + 8 * i));
  if (header.version() == 1) {
    code = header.at<std::int16_t>(70);
    data_offset = header.at<float>(108);
    slope = header.at<float>(112);
    intercept = header.at<float>(116);
  } else {
    code = header.at<std::int16_t>(12);
    data_offset = double(header.at<std::int64_t>(168));
    slope = header.at<double>(176);
    intercept = header.at<double>(184);
  }
  if (dim[0] < 1 || dim[0] > 7)
    fail_nifti(path, fmt::format("its header speaks of {} axes, not 1 to 7; get the file again", dim[0]));
  std::array<std::int64_t, 3> size{1, 1, 1};
  for (std::size_t axis = 0; axis < 3 && std::int64_t(axis) < dim[0]; ++axis) size[axis] = dim[axis + 1];
  description.type = type_of(code, path);
  checked_bytes(size, description.type, path);
  for (std::size_t axis = 0; axis < 3; ++axis) description.size[axis] = int(size[axis]);
  if (slope != 0 && std::isfinite(slope) && std::isfinite(intercept)) {
    description.scale = slope;
    description.offset = intercept;
  }
  if (!(data_offset >= 0 && data_offset <= largest_offset))
    fail_nifti(path, fmt::format("its data would begin at byte {}; get the file again", data_offset));

  // Some writers set the lengths of absent axes to 0.
  description.time_steps = dim[0] < 4 ? 1 : checked_time_steps(std::max<std::int64_t>(dim[4], 1), path);

  DenseScalars scalars;
  scalars.offset = std::uint64_t(data_offset);
  scalars.time_step = time_step;
  scalars.big_endian = header.big_endian();
  scalars.advice = "its header asks for more than it holds: get the file again";
  if (header.one_file()) {
    if (scalars.offset < header_bytes_1)
      fail_nifti(path, fmt::format("its data would begin at byte {}, within its header; get the file again",
                                   scalars.offset));
    scalars.bytes = std::move(file);
  } else {
    scalars.bytes = open_file_or_gzip(
        is_part(header_path, ".hdr") ? with_part(header_path, ".hdr", ".img") : header_path, files);
  }
  return dense_volume(description, std::move(scalars));
}

}  // namespace understudy::volume
