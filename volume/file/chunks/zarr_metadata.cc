// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/zarr_metadata.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "volume/cell_lattice.h"
#include "volume/file/byte_source.h"
#include "volume/file/file_error.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

namespace {

using nlohmann::json;

constexpr std::size_t most_metadata_bytes = std::size_t(1) << 20;
constexpr std::size_t most_zarr_axes = 5;

[[noreturn]] void fail_zarr(const std::string& path, const std::string& what) {
  throw FileError(fmt::format("{}: Zarr: {}", path, what));
}

std::string file_in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

/// Null where there is no such file.
json json_in(const std::string& folder, const char* name, const ReadableFiles& files) {
  const std::string path = file_in(folder, name);
  const std::unique_ptr<ByteSource> file = open_file_if_there(path, files);
  if (!file) return {};
  const std::uint64_t bytes = file->size().value_or(0);
  if (bytes > most_metadata_bytes) fail_zarr(path, "its JSON is too long; get it again");
  std::string text(std::size_t(bytes), '\0');
  text.resize(file->read(0, std::as_writable_bytes(std::span(text))));
  json read = json::parse(text, nullptr, false);
  if (!read.is_object()) fail_zarr(path, "it is no JSON object; get it again");
  return read;
}

/// What nlohmann-json throws of values of other types than they should have.
template <typename Function>
auto with_json(const std::string& path, const Function& function) {
  try {
    return function();
  } catch (const json::exception& error) {
    fail_zarr(path, fmt::format("its metadata is damaged ({}); get it again", error.what()));
  }
}

ScalarType type_of(const json& dtype, const std::string& path) {
  static const std::map<std::string, ScalarType> names{
      {"u1", ScalarType::u8},  {"i1", ScalarType::i8},  {"u2", ScalarType::u16}, {"i2", ScalarType::i16},
      {"u4", ScalarType::u32}, {"i4", ScalarType::i32}, {"u8", ScalarType::u64}, {"i8", ScalarType::i64},
      {"f4", ScalarType::f32}, {"f8", ScalarType::f64}};
  const std::string text = dtype.is_string() ? dtype.get<std::string>() : "with fields";
  const auto found = names.find(text.size() == 3 ? text.substr(1) : "");
  if (found == names.end())
    fail_zarr(path,
              fmt::format("elements of type {} are no scalars that can be drawn; convert them first", text));
  return found->second;
}

ChunkCodec codec_of(const json& compressor, const std::string& path) {
  if (compressor.is_null()) return ChunkCodec::none;
  static const std::map<std::string, ChunkCodec> names{{"blosc", ChunkCodec::blosc},
                                                       {"zlib", ChunkCodec::zlib},
                                                       {"gzip", ChunkCodec::zlib},
                                                       {"zstd", ChunkCodec::zstd},
                                                       {"lz4", ChunkCodec::lz4}};
  const auto id = compressor.at("id").get<std::string>();
  const auto found = names.find(id);
  if (found == names.end())
    fail_zarr(
        path,
        fmt::format("chunks compressed by '{}' are not read; write them with blosc, zlib, zstd or lz4", id));
  return found->second;
}

double fill_of(const json& fill) {
  if (fill.is_number()) return fill.get<double>();
  if (fill == "NaN") return std::numeric_limits<double>::quiet_NaN();
  if (fill == "Infinity") return std::numeric_limits<double>::infinity();
  if (fill == "-Infinity") return -std::numeric_limits<double>::infinity();
  return 0;  // null: whoever wrote the file did not care
}

void check_lengths(const ZarrArray& array, const std::string& path) {
  constexpr std::int64_t longest = std::int64_t(1) << 20;
  if (array.shape.empty() || array.shape.size() > most_zarr_axes || array.chunks.size() != array.shape.size())
    fail_zarr(path, fmt::format("it has {} axes and chunks of {}; up to {} are read", array.shape.size(),
                                array.chunks.size(), most_zarr_axes));
  std::uint64_t bytes = bytes_per_scalar(array.type);
  for (std::size_t axis = 0; axis < array.shape.size(); ++axis) {
    if (array.shape[axis] < 1 || array.shape[axis] > longest || array.chunks[axis] < 1 ||
        array.chunks[axis] > longest)
      fail_zarr(path, fmt::format(
                          "it has {} elements along axis {}, in chunks of {}, not 1 to {}; check its metadata",
                          array.shape[axis], axis, array.chunks[axis], longest));
    bytes *= std::uint64_t(array.chunks[axis]);
    if (bytes > std::uint64_t(std::numeric_limits<int>::max()))
      fail_zarr(path, "its chunks have 2 GiB or more; write smaller ones");
  }
}

struct NamedAxis {
  ZarrAxis axis;
  double metres = 1;  ///< of its unit
};

/// Versions before 0.4 have names alone, the first ones none.
std::vector<NamedAxis> axes_of(const json& scales, std::size_t count, const std::string& path) {
  static const std::map<std::string, ZarrAxis> names{{"t", ZarrAxis::time},
                                                     {"c", ZarrAxis::channel},
                                                     {"z", ZarrAxis::z},
                                                     {"y", ZarrAxis::y},
                                                     {"x", ZarrAxis::x}};
  static const std::map<std::string, double> units{
      {"angstrom", 1e-10},  {"picometer", 1e-12}, {"nanometer", 1e-9}, {"micrometer", 1e-6},
      {"millimeter", 1e-3}, {"centimeter", 1e-2}, {"meter", 1}};
  if (!scales.contains("axes")) {
    const std::vector<NamedAxis> all{
        {ZarrAxis::time}, {ZarrAxis::channel}, {ZarrAxis::z}, {ZarrAxis::y}, {ZarrAxis::x}};
    return {all.end() - std::ptrdiff_t(std::min(count, all.size())), all.end()};
  }
  if (scales.at("axes").size() > most_zarr_axes)
    fail_zarr(path, fmt::format("it has {} axes; up to {} are read", scales.at("axes").size(), most_zarr_axes));
  std::vector<NamedAxis> axes;
  double told = 0;  // the unit of the other axes stands for one that is left out
  for (const json& axis : scales.at("axes")) {
    const auto name = axis.is_string() ? axis.get<std::string>() : axis.at("name").get<std::string>();
    const auto found = names.find(name);
    if (found == names.end())
      fail_zarr(path, fmt::format("it has an axis '{}'; t, c, z, y and x are read", name));
    axes.push_back({found->second, 0});
    const bool has_unit = axis.is_object() && axis.contains("unit") && axis.at("unit").is_string();
    if (found->second < ZarrAxis::z || !has_unit) continue;
    const auto unit = units.find(axis.at("unit").get<std::string>());
    if (unit == units.end())
      fail_zarr(path, fmt::format("its axis {} is in '{}', which is not known; give it in micrometers", name,
                                  axis.at("unit").get<std::string>()));
    axes.back().metres = told = unit->second;
  }
  for (NamedAxis& axis : axes)
    if (axis.metres == 0) axis.metres = told == 0 ? 1 : told;
  return axes;
}

/// Scales of an array's axes, or none.
std::vector<double> scale_in(const json& entry) {
  if (!entry.contains("coordinateTransformations")) return {};
  for (const json& transformation : entry.at("coordinateTransformations"))
    if (transformation.at("type") == "scale" && transformation.contains("scale"))
      return transformation.at("scale").get<std::vector<double>>();
  return {};
}

/// Of a dataset of the image in `folder`.
std::string folder_of(const json& dataset, const std::string& folder) {
  const std::filesystem::path below = dataset.at("path").get<std::string>();
  if (below.is_absolute() || std::ranges::find(below, "..") != below.end())
    fail_zarr(folder,
              fmt::format("one of its levels lies elsewhere ({}); put it into this folder", below.string()));
  return file_in(folder, below.string());
}

ZarrImage image_of(const json& scales, const std::string& folder, int level, const ReadableFiles& files) {
  const json& datasets = scales.at("datasets");
  if (level < 0 || std::size_t(level) >= datasets.size())
    fail_zarr(folder, fmt::format("it has no level {}; it has {}, counted from 0", level, datasets.size()));
  const json& dataset = datasets.at(std::size_t(level));
  ZarrImage image;
  image.folder = folder_of(dataset, folder);
  const std::vector<std::int64_t> shape = zarr_array(image.folder, files).shape;
  const std::vector<NamedAxis> axes = axes_of(scales, shape.size(), folder);
  const std::vector<double> own = scale_in(dataset), common = scale_in(scales);
  // The first versions tell no scales: a level is as large as the finest one.
  std::vector<std::int64_t> finest = shape;
  if (own.empty() && level > 0) finest = zarr_array(folder_of(datasets.at(0), folder), files).shape;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    image.axes.push_back(axes[i].axis);
    if (axes[i].axis < ZarrAxis::z || i >= shape.size() || i >= finest.size()) continue;
    const double scale = i < own.size() ? own[i] : double(finest[i]) / double(shape[i]);
    image.spacing[std::size_t(ZarrAxis::x) - std::size_t(axes[i].axis)] =
        scale * (i < common.size() ? common[i] : 1) * axes[i].metres;
  }
  // In the unit of the x axis, which is as good as any.
  const auto x = std::ranges::find(axes, ZarrAxis::x, &NamedAxis::axis);
  for (const NamedAxis& axis : axes) {
    if (axis.axis < ZarrAxis::z || x == axes.end()) continue;
    double& spacing = image.spacing[std::size_t(ZarrAxis::x) - std::size_t(axis.axis)];
    spacing = believable_spacing(spacing / x->metres);
  }
  return image;
}

/// Of an array that is no image: as its names say, or the last of t, c, z, y, x.
std::vector<ZarrAxis> axes_of_array(const json& attributes, std::size_t count, const std::string& folder) {
  static const std::map<std::string, ZarrAxis> names{
      {"t", ZarrAxis::time}, {"time", ZarrAxis::time}, {"c", ZarrAxis::channel}, {"channel", ZarrAxis::channel},
      {"z", ZarrAxis::z},    {"y", ZarrAxis::y},       {"x", ZarrAxis::x}};
  if (attributes.is_object() && attributes.contains("_ARRAY_DIMENSIONS")) {
    std::vector<ZarrAxis> axes;
    for (const json& name : attributes.at("_ARRAY_DIMENSIONS")) {
      const auto found = names.find(name.get<std::string>());
      if (found == names.end() || axes.size() >= most_zarr_axes)
        fail_zarr(folder,
                  fmt::format("it has a dimension '{}'; t, c, z, y and x are read", name.get<std::string>()));
      axes.push_back(found->second);
    }
    return axes;
  }
  std::vector<ZarrAxis> axes{ZarrAxis::time, ZarrAxis::channel, ZarrAxis::z, ZarrAxis::y, ZarrAxis::x};
  axes.erase(axes.begin(), axes.end() - std::ptrdiff_t(std::min(count, axes.size())));
  if (count == 4) axes.front() = ZarrAxis::time;  // as files of other formats have it
  return axes;
}

}  // namespace

bool is_zarr(const std::string& folder, const ReadableFiles& files) {
  return std::ranges::any_of(std::array{".zarray", ".zgroup", "zarr.json"}, [&](const char* name) {
    return open_file_if_there(file_in(folder, name), files) != nullptr;
  });
}

ZarrImage zarr_image(const std::string& folder, int level, const ReadableFiles& files) {
  return with_json(folder, [&]() -> ZarrImage {
    const bool is_array = open_file_if_there(file_in(folder, ".zarray"), files) != nullptr;
    if (!is_array && !open_file_if_there(file_in(folder, ".zgroup"), files))
      fail_zarr(folder, "it is of version 3, of which version 2 is read; write it with zarr_format=2");
    const json attributes = json_in(folder, ".zattrs", files);
    if (attributes.is_object() && attributes.contains("multiscales"))
      return image_of(attributes.at("multiscales").at(0), folder, level, files);
    if (!is_array)
      fail_zarr(
          folder,
          "it is a group without an image; give an array or an OME-Zarr image in it, such as the folder 0");
    if (level != 0) fail_zarr(folder, fmt::format("an array alone has no level {}; leave out --level", level));
    // An array of an image does not know its axes.
    const std::filesystem::path above = std::filesystem::path(folder).lexically_normal();
    const std::string parent = (above.has_filename() ? above : above.parent_path()).parent_path().string();
    if (!parent.empty()) {
      const json image = json_in(parent, ".zattrs", files);
      if (image.is_object() && image.contains("multiscales"))
        fail_zarr(folder, fmt::format("it is a level of the image {}; give that folder, and --level", parent));
    }
    ZarrImage image;
    image.folder = folder;
    image.axes = axes_of_array(attributes, zarr_array(folder, files).shape.size(), folder);
    return image;
  });
}

ZarrArray zarr_array(const std::string& folder, const ReadableFiles& files) {
  const std::string path = file_in(folder, ".zarray");
  return with_json(path, [&] {
    const json read = json_in(folder, ".zarray", files);
    if (read.is_null()) fail_zarr(path, "there is no such file; get the volume again");
    ZarrArray array;
    array.shape = read.at("shape").get<std::vector<std::int64_t>>();
    array.chunks = read.at("chunks").get<std::vector<std::int64_t>>();
    array.type = type_of(read.at("dtype"), path);
    array.big_endian = read.at("dtype").get<std::string>().front() == '>';
    array.first_axis_fastest = read.value("order", "C") == "F";
    // Older programs wrote folders without saying so.
    const bool has_folders = array.shape.size() > 1 && files.is_folder(file_in(folder, "0"));
    array.separator = read.value("dimension_separator", has_folders ? "/" : ".") == "/" ? '/' : '.';
    if (read.contains("filters") && !read.at("filters").is_null() && !read.at("filters").empty())
      fail_zarr(path, "its chunks went through filters; write them without");
    array.codec = codec_of(read.at("compressor"), path);
    array.fill = fill_of(read.at("fill_value"));
    check_lengths(array, path);
    return array;
  });
}

}  // namespace understudy::volume
