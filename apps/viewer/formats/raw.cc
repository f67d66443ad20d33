#include "apps/viewer/formats/raw.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <filesystem>
#include <regex>

#include "apps/viewer/error.h"
#include "apps/viewer/formats/bytes.h"

namespace viewer {

namespace {

constexpr std::pair<std::string_view, ScalarType> long_type_names[] = {{"uint8", ScalarType::u8},
                                                                       {"int8", ScalarType::i8},
                                                                       {"uint16", ScalarType::u16},
                                                                       {"int16", ScalarType::i16},
                                                                       {"float32", ScalarType::f32}};

// Wrong sizes are usually a wrong type: say which type the file's length speaks for.
std::string advice_for(const std::string& path, const VolumeSize& size, ScalarType type) {
  std::string advice =
      fmt::format("{} voxels of {} were expected; check --size and --type", text_of(size), name_of(type));
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

}  // namespace

std::optional<NamedLayout> layout_in_name(const std::string& path) {
  static const std::regex pattern(
      R"((?:^|[._-])(\d{1,9})x(\d{1,9})x(\d{1,9})(?:[._-](uint8|int8|uint16|int16|float32|u8|i8|u16|i16|f32))?(?=[._-]|$))");
  const std::string name = std::filesystem::path(path).filename().string();
  std::smatch match;
  if (!std::regex_search(name, match, pattern)) return std::nullopt;
  NamedLayout layout{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string digits = match[axis + 1];
    std::from_chars(digits.data(), digits.data() + digits.size(), layout.size[axis]);
  }
  const std::string type = match[4];
  layout.type = scalar_type_named(type);
  for (const auto& [long_name, scalar_type] : long_type_names)
    if (type == long_name) layout.type = scalar_type;
  return layout;
}

Volume load_raw(const std::string& path, const VolumeHints& hints) {
  const std::optional<NamedLayout> named = layout_in_name(path);
  if (!hints.size && !named)
    throw Error(
        ExitCode::bad_file,
        fmt::format("{}: the size of these raw voxels is unknown; give --size X Y Z (and --type), or put it in "
                    "the file's name as in engine.256x256x110",
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
