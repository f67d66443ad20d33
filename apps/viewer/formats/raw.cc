// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/formats/raw.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <filesystem>

#include "apps/viewer/formats/bytes.h"
#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

constexpr std::pair<std::string_view, ScalarType> long_type_names[] = {{"uint8", ScalarType::u8},
                                                                       {"int8", ScalarType::i8},
                                                                       {"uint16", ScalarType::u16},
                                                                       {"int16", ScalarType::i16},
                                                                       {"float32", ScalarType::f32}};

// A wrong file size is usually caused by a wrong type: suggest the type that fits the file's length.
std::string advice_for(const std::string& path, const VolumeSize& size, ScalarType type) {
  std::string advice =
      fmt::format("expected {} voxels of type {}; check --size and --type", text_of(size), name_of(type));
  std::error_code no_size;
  const auto found = std::filesystem::file_size(path, no_size);
  const auto voxels = static_cast<std::uintmax_t>(size[0] * size[1] * size[2]);
  if (!no_size && !has_extension(path, ".gz") && found % voxels == 0) {
    if (found / voxels == 1 && type != ScalarType::i8) advice += " (--type u8 would fit)";
    if (found / voxels == 2) advice += " (--type u16 or i16 would fit)";
    if (found / voxels == 4) advice += " (--type f32 would fit)";
  }
  return advice;
}

// Parses, for example, "256x256x110".
std::optional<VolumeSize> size_in_word(std::string_view word) {
  VolumeSize size{};
  const char* at = word.data();
  const char* const end = at + word.size();
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0 && (at == end || *at++ != 'x')) return std::nullopt;
    const auto [stop, error] = std::from_chars(at, end, size[axis]);
    if (error != std::errc()) return std::nullopt;
    at = stop;
  }
  return at == end ? std::optional(size) : std::nullopt;
}

std::optional<ScalarType> type_in_word(std::string_view word) {
  for (const auto& [long_name, type] : long_type_names)
    if (word == long_name) return type;
  return scalar_type_named(word);
}

}  // namespace

std::optional<NamedLayout> layout_in_name(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  constexpr std::string_view separators = "._-";
  NamedLayout layout{};
  bool sized = false;
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find_first_of(separators, begin), name.size());
    const std::string_view word = std::string_view(name).substr(begin, end - begin);
    if (!sized) {
      if (const std::optional<VolumeSize> size = size_in_word(word)) {
        layout.size = *size;
        sized = true;
      }
    } else if (!layout.type) {
      layout.type = type_in_word(word);
    }
    begin = end + 1;
  }
  return sized ? std::optional(layout) : std::nullopt;
}

Volume load_raw(const std::string& path, const VolumeHints& hints) {
  const std::optional<NamedLayout> named = layout_in_name(path);
  if (!hints.size && !named)
    throw Error(ExitCode::bad_file,
                fmt::format("{}: the size of this raw file is unknown; give --size X Y Z (and --type), or put "
                            "the size into the file's name, as in engine.256x256x110",
                            path));
  Volume volume;
  volume.size = hints.size ? *hints.size : named->size;
  volume.type = hints.type ? *hints.type : named && named->type ? *named->type : ScalarType::u8;
  const std::int64_t bytes = volume_bytes(volume.size, volume.type, path);
  volume.voxels = read_bytes(path, 0, bytes, Remainder::forbidden, advice_for(path, volume.size, volume.type));
  if (hints.big_endian != (std::endian::native == std::endian::big))
    swap_byte_order(volume.voxels, bytes_per_voxel(volume.type));
  return volume;
}

}  // namespace viewer
