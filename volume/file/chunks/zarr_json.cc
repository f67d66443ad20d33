// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/zarr_json.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "volume/file/byte_source.h"
#include "volume/file/scalar_dispatch.h"

namespace understudy::volume {

namespace {

/// Generous, because labels and properties of an image may be long.
constexpr std::size_t most_metadata_bytes = std::size_t(8) << 20;
/// Limits recursion: copying a value takes a function call per level.
constexpr int deepest = 64;

template <typename Scalar>
std::vector<std::byte> bytes_of(Scalar scalar) {
  std::vector<std::byte> bytes(sizeof scalar);
  std::memcpy(bytes.data(), &scalar, sizeof scalar);
  return bytes;
}

/// Integers of eight bytes may be too long for a double, so they are not converted to one.
template <typename Scalar>
std::optional<Scalar> scalar_of(const nlohmann::json& number) {
  if constexpr (std::is_floating_point_v<Scalar>) {
    return Scalar(number.get<double>());
  } else {
    const double value = number.get<double>();
    if (number.is_number_unsigned() && std::in_range<Scalar>(number.get<std::uint64_t>()))
      return Scalar(number.get<std::uint64_t>());
    if (number.is_number_integer() && !number.is_number_unsigned() &&
        std::in_range<Scalar>(number.get<std::int64_t>()))
      return Scalar(number.get<std::int64_t>());
    // Some programs write 0.0; all integers up to this one are exact as doubles.
    constexpr double exact = 9007199254740992;
    if (number.is_number_float() && std::abs(value) <= exact && value == std::trunc(value) &&
        std::in_range<Scalar>(std::int64_t(value)))
      return Scalar(value);
    return std::nullopt;
  }
}

std::optional<std::uint64_t> bits_in(std::string_view text, std::size_t bytes) {
  if (!text.starts_with("0x") || text.size() != 2 + 2 * bytes) return std::nullopt;
  std::uint64_t bits = 0;
  const char* const end = text.data() + text.size();
  if (std::from_chars(text.data() + 2, end, bits, 16).ptr != end) return std::nullopt;
  return bits;
}

template <typename Float>
std::optional<Float> float_named(std::string_view text, Storage storage) {
  if (text == "NaN") return std::numeric_limits<Float>::quiet_NaN();
  if (text == "Infinity") return std::numeric_limits<Float>::infinity();
  if (text == "-Infinity") return -std::numeric_limits<Float>::infinity();
  // NaNs with another payload.
  const bool is_half = storage == Storage::half;
  const std::optional<std::uint64_t> bits = bits_in(text, is_half ? sizeof(std::uint16_t) : sizeof(Float));
  if (!bits) return std::nullopt;
  if (is_half) return Float(float_of_half(std::uint16_t(*bits)));
  using Bits = std::conditional_t<sizeof(Float) == 4, std::uint32_t, std::uint64_t>;
  return std::bit_cast<Float>(Bits(*bits));
}

template <typename Scalar>
std::optional<Scalar> fill_of(const nlohmann::json& fill, Storage storage) {
  if (fill.is_null()) return Scalar{};  // undefined: any value will do
  if (storage == Storage::boolean && fill.is_boolean()) return Scalar(fill.get<bool>() ? 1 : 0);
  if (fill.is_number()) return scalar_of<Scalar>(fill);
  if constexpr (std::is_floating_point_v<Scalar>)
    if (fill.is_string()) return float_named<Scalar>(fill.get<std::string>(), storage);
  return std::nullopt;
}

}  // namespace

void fail_zarr(const std::string& path, const std::string& what) {
  throw FileError(fmt::format("{}: Zarr: {}", path, what));
}

nlohmann::json json_in(const std::string& folder, const char* name, const ReadableFiles& files) {
  const std::string path = path_in(folder, name);
  const std::unique_ptr<ByteSource> file = open_file_if_there(path, files);
  if (!file) return {};
  const std::uint64_t bytes = file->size().value_or(0);
  if (bytes > most_metadata_bytes)
    fail_zarr(path, fmt::format("its JSON has more than {} MiB; take out what is not needed to show it",
                                most_metadata_bytes >> 20));
  std::string text(std::size_t(bytes), '\0');
  text.resize(file->read(0, std::as_writable_bytes(std::span(text))));
  const auto check_depth = [&](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > deepest)
      fail_zarr(path, fmt::format("its JSON is more than {} levels deep; get it again", deepest));
    return true;
  };
  nlohmann::json read = nlohmann::json::parse(text, check_depth, false);
  if (!read.is_object()) fail_zarr(path, "it is no JSON object; get it again");
  return read;
}

ChunkCodec zarr_codec(const std::string& name, const std::string& path) {
  static const std::map<std::string, ChunkCodec> names{{"blosc", ChunkCodec::blosc},
                                                       {"zlib", ChunkCodec::zlib},
                                                       {"gzip", ChunkCodec::zlib},
                                                       {"zstd", ChunkCodec::zstd},
                                                       {"lz4", ChunkCodec::lz4}};
  const auto found = names.find(name);
  if (found == names.end())
    fail_zarr(
        path,
        fmt::format("chunks compressed by '{}' are not read; write them with blosc, zlib, zstd or lz4", name));
  return found->second;
}

std::string zarr_text(const nlohmann::json& value) {
  constexpr std::size_t most_shown = 60;
  const std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return text.size() <= most_shown ? text : text.substr(0, most_shown) + "...";
}

std::vector<std::int64_t> zarr_lengths(const nlohmann::json& numbers, const std::string& path) {
  std::vector<std::int64_t> lengths;
  for (const nlohmann::json& number : numbers) {
    if (!number.is_number_integer())
      fail_zarr(path, fmt::format("a length in it is {}; get it again", zarr_text(number)));
    lengths.push_back(number.get<std::int64_t>());
  }
  return lengths;
}

std::vector<std::byte> zarr_fill_value(const nlohmann::json& fill, const ElementType& element,
                                       const std::string& path) {
  const ScalarType type = element.type;
  std::vector<std::byte> bytes;
  const auto read = [&]<typename Scalar>(Scalar) {
    const std::optional<Scalar> scalar = fill_of<Scalar>(fill, element.storage);
    if (!scalar)
      fail_zarr(path, fmt::format("its fill value {} is none of type {}; get it again", zarr_text(fill),
                                  name_of(type)));
    bytes = bytes_of(*scalar);
  };
  if (type == ScalarType::u64)
    read(std::uint64_t{});
  else if (type == ScalarType::i64)
    read(std::int64_t{});
  else
    with_sample_type(type, read);
  return bytes;
}

}  // namespace understudy::volume
