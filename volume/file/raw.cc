// SPDX-License-Identifier: Apache-2.0
#include "volume/file/raw.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>

#include "volume/cell_lattice.h"
#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

/// "256x256x110"
std::optional<std::array<int, 3>> size_in_word(std::string_view word) {
  std::array<int, 3> size{};
  const char* at = word.data();
  const char* const end = at + word.size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis > 0 && (at == end || *at++ != 'x')) return std::nullopt;
    const auto [stop, error] = std::from_chars(at, end, size[axis]);
    if (error != std::errc()) return std::nullopt;
    at = stop;
  }
  return at == end ? std::optional(size) : std::nullopt;
}

/// "uint16", "int16be", "f32le"
void take_type(std::string_view word, FileHints& hints) {
  hints.type = scalar_type_named(word);
  if (hints.type || word.size() < 2) return;
  const std::string_view order = word.substr(word.size() - 2);
  if (order != "be" && order != "le") return;
  hints.type = scalar_type_named(word.substr(0, word.size() - 2));
  if (hints.type) hints.big_endian = order == "be";
}

// A wrong length usually means a wrong type: suggests the type that matches the file's length.
std::string advice_for(const std::array<int, 3>& size, ScalarType type, std::optional<std::uint64_t> found) {
  std::string advice = fmt::format("{} x {} x {} scalars of {} were expected: check the size and the type",
                                   size[0], size[1], size[2], name_of(type));
  // dense_volume() refuses other sizes, whose product could overflow.
  const bool possible = std::ranges::all_of(size, [](int n) { return n >= 1 && n <= max_axis_texels; });
  if (!found || !possible) return advice;
  std::uint64_t scalars = 1;
  for (const int extent : size) scalars *= std::uint64_t(extent);
  if (*found % scalars != 0) return advice;
  const std::uint64_t each = *found / scalars;
  if (each == 1) advice += " (u8 would fit)";
  if (each == 2) advice += " (u16 or i16 would fit)";
  if (each == 4) advice += " (f32 would fit)";
  if (each == 8) advice += " (f64 would fit)";
  return advice;
}

}  // namespace

FileHints hints_in_name(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  FileHints hints;
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find_first_of("._-", begin), name.size());
    const std::string_view word = std::string_view(name).substr(begin, end - begin);
    if (!hints.size) {
      hints.size = size_in_word(word);
    } else if (!hints.type) {
      take_type(word, hints);
    }
    begin = end + 1;
  }
  return hints;
}

std::unique_ptr<VolumeFile> open_raw(const std::string& path, const FileHints& hints,
                                     const ReadableFiles& files) {
  std::unique_ptr<ByteSource> bytes = open_file_or_gzip(path, files);
  const FileHints named = hints_in_name(path);
  const std::optional<std::array<int, 3>> size = hints.size ? hints.size : named.size;
  if (!size)
    throw FileError(fmt::format(
        "{}: the size of these raw scalars is unknown; give it (--volume-size X Y Z, and --type), or put "
        "it in the file's name as in engine_256x256x110_uint8.raw",
        path));
  FileDescription description;
  description.size = *size;
  description.type = hints.type.value_or(named.type.value_or(ScalarType::u8));
  DenseScalars scalars;
  scalars.big_endian = hints.big_endian.value_or(named.big_endian.value_or(false));
  scalars.nothing_follows = true;
  scalars.advice = advice_for(*size, description.type, bytes->size());
  scalars.bytes = std::move(bytes);
  return dense_volume(description, std::move(scalars));
}

}  // namespace understudy::volume
