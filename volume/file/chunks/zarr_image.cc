// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/zarr_image.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "volume/cell_lattice.h"
#include "volume/file/byte_source.h"
#include "volume/file/chunks/zarr_array.h"
#include "volume/file/chunks/zarr_json.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

namespace {

using nlohmann::json;

struct NamedAxis {
  ZarrAxis axis;
  double metres = 1;  ///< length of the axis's unit
};

/// Empty if `name` is not the name of an axis.
std::optional<ZarrAxis> axis_named(std::string name) {
  static const std::map<std::string, ZarrAxis> names{
      {"t", ZarrAxis::time}, {"time", ZarrAxis::time}, {"c", ZarrAxis::channel}, {"channel", ZarrAxis::channel},
      {"z", ZarrAxis::z},    {"y", ZarrAxis::y},       {"x", ZarrAxis::x}};
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  const auto found = names.find(name);
  return found == names.end() ? std::nullopt : std::optional(found->second);
}

/// The units of length that OME-Zarr lists, except astronomical ones.
std::optional<double> metres_of(const std::string& unit) {
  static const std::map<std::string, double> units{{"yoctometer", 1e-24},
                                                   {"zeptometer", 1e-21},
                                                   {"attometer", 1e-18},
                                                   {"femtometer", 1e-15},
                                                   {"picometer", 1e-12},
                                                   {"angstrom", 1e-10},
                                                   {"nanometer", 1e-9},
                                                   {"nm", 1e-9},
                                                   {"micrometer", 1e-6},
                                                   {"micron", 1e-6},
                                                   {"um", 1e-6},
                                                   {"\u00b5m", 1e-6},
                                                   {"\u03bcm", 1e-6},
                                                   {"millimeter", 1e-3},
                                                   {"mm", 1e-3},
                                                   {"centimeter", 1e-2},
                                                   {"cm", 1e-2},
                                                   {"inch", 0.0254},
                                                   {"decimeter", 0.1},
                                                   {"foot", 0.3048},
                                                   {"yard", 0.9144},
                                                   {"meter", 1},
                                                   {"m", 1},
                                                   {"hectometer", 1e2},
                                                   {"kilometer", 1e3},
                                                   {"mile", 1609.344},
                                                   {"megameter", 1e6},
                                                   {"gigameter", 1e9}};
  const auto found = units.find(unit);
  return found == units.end() ? std::nullopt : std::optional(found->second);
}

/// Sets the metres of all spatial axes if their units differ. An axis without a unit takes the unit of the
/// others. If all share one unit, or have none, only ratios matter and nothing is set.
void set_units(std::vector<NamedAxis>& axes, const std::vector<std::string>& units, const std::string& path) {
  std::string shared;
  bool differ = false;
  for (const std::string& unit : units) {
    if (unit.empty()) continue;
    differ |= !shared.empty() && unit != shared;
    shared = unit;
  }
  if (!differ) return;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].axis < ZarrAxis::z) continue;
    const std::string& unit = units[i].empty() ? shared : units[i];
    const std::optional<double> metres = metres_of(unit);
    if (!metres)
      fail_zarr(path,
                fmt::format("one of its axes is in '{}', others are not, and it is not known how long that is; "
                            "give all of them in one unit",
                            unit));
    axes[i].metres = *metres;
  }
}

ZarrAxis axis_of(const json& axis, const std::string& path) {
  const auto name = axis.is_string() ? axis.get<std::string>() : axis.at("name").get<std::string>();
  const std::string type = axis.is_object() ? axis.value("type", "") : "";
  if (type == "time") return ZarrAxis::time;
  if (type == "channel") return ZarrAxis::channel;
  const std::optional<ZarrAxis> named = axis_named(name);
  if (!named) fail_zarr(path, fmt::format("it has an axis '{}'; name them t, c, z, y and x", name));
  return *named;
}

/// Version 0.3 has only names, and earlier ones have none: there, the axes are the last of t, c, z, y and x.
std::vector<NamedAxis> axes_of(const json& scales, std::size_t count, const std::string& path) {
  if (!scales.contains("axes")) {
    const std::string version = scales.value("version", "0.1");
    if (version != "0.1" && version != "0.2")
      fail_zarr(path, fmt::format("it tells no axes, as OME-Zarr {} has to; check its metadata", version));
    const std::vector<NamedAxis> all{
        {ZarrAxis::time}, {ZarrAxis::channel}, {ZarrAxis::z}, {ZarrAxis::y}, {ZarrAxis::x}};
    return {all.end() - std::ptrdiff_t(std::min(count, all.size())), all.end()};
  }
  if (scales.at("axes").size() > most_zarr_axes)
    fail_zarr(path, fmt::format("it has {} axes; up to {} are read", scales.at("axes").size(), most_zarr_axes));
  std::vector<NamedAxis> axes;
  std::vector<std::string> units;
  for (const json& axis : scales.at("axes")) {
    axes.push_back({axis_of(axis, path)});
    const bool has_unit = axis.is_object() && axis.contains("unit") && axis.at("unit").is_string();
    units.push_back(has_unit && axes.back().axis >= ZarrAxis::z ? axis.at("unit").get<std::string>() : "");
  }
  set_units(axes, units, path);
  return axes;
}

/// Refuses later versions, which specify sample positions differently.
void check_version(const json& version, const std::string& path) {
  static constexpr std::array read{"0.1", "0.2", "0.3", "0.4", "0.5"};
  if (!version.is_string()) return;
  const auto text = version.get<std::string>();
  if (std::ranges::none_of(read, [&](std::string_view known) { return text.starts_with(known); }))
    fail_zarr(path, fmt::format("it is of OME-Zarr {}, of which {} to {} are read; write {}", text,
                                read.front(), read.back(), read.back()));
}

/// The scales of an array's axes, or none.
std::vector<double> scale_in(const json& entry) {
  if (!entry.contains("coordinateTransformations")) return {};
  for (const json& transformation : entry.at("coordinateTransformations"))
    if (transformation.at("type") == "scale" && transformation.contains("scale"))
      return transformation.at("scale").get<std::vector<double>>();
  return {};
}

/// The folder of a dataset of the image in `folder`.
std::string folder_of(const json& dataset, const std::string& folder) {
  const std::filesystem::path below = dataset.at("path").get<std::string>();
  if (below.is_absolute() || std::ranges::find(below, "..") != below.end())
    fail_zarr(folder,
              fmt::format("one of its levels lies elsewhere ({}); put it into this folder", below.string()));
  return path_in(folder, below.string());
}

ZarrImage image_of(const json& scales, const std::string& folder, int level, const ReadableFiles& files) {
  check_version(scales.value("version", json()), folder);
  const json& datasets = scales.at("datasets");
  if (level < 0 || std::size_t(level) >= datasets.size())
    fail_zarr(folder, fmt::format("it has no level {}; it has {}, counted from 0", level, datasets.size()));
  const json& dataset = datasets.at(std::size_t(level));
  ZarrImage image;
  image.levels = int(datasets.size());
  image.folder = folder_of(dataset, folder);
  const std::vector<std::int64_t> shape = zarr_array(image.folder, files).shape;
  const std::vector<NamedAxis> axes = axes_of(scales, shape.size(), folder);
  const std::vector<double> own = scale_in(dataset), common = scale_in(scales);
  // The first versions specify no scales: every level has the extent of the finest one.
  std::vector<std::int64_t> finest = shape;
  if (own.empty() && level > 0) finest = zarr_array(folder_of(datasets.at(0), folder), files).shape;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    image.axes.push_back(axes[i].axis);
    if (axes[i].axis < ZarrAxis::z || i >= shape.size() || i >= finest.size()) continue;
    const double scale = i < own.size() ? own[i] : double(finest[i]) / double(shape[i]);
    image.spacing[volume_axis(axes[i].axis)] = scale * (i < common.size() ? common[i] : 1) * axes[i].metres;
  }
  // In the unit of the x axis; any unit would do.
  const auto x = std::ranges::find(axes, ZarrAxis::x, &NamedAxis::axis);
  for (const NamedAxis& axis : axes) {
    if (axis.axis < ZarrAxis::z || x == axes.end()) continue;
    double& spacing = image.spacing[volume_axis(axis.axis)];
    spacing = believable_spacing(spacing / x->metres);
  }
  return image;
}

/// The metadata of a folder.
struct ZarrNode {
  bool is_array = false;
  json attributes;       ///< null if it has none
  json dimension_names;  ///< of an array, likewise
};

/// An array can be shown without attributes; Python writes numbers into them that JSON lacks (NaN).
json attributes_of_array(const std::string& folder, const ReadableFiles& files) {
  try {
    return json_in(folder, ".zattrs", files);
  } catch (const FileError&) {
    return {};
  }
}

/// Empty if the folder has no metadata.
std::optional<ZarrNode> node_in(const std::string& folder, const ReadableFiles& files) {
  const json of_version_3 = json_in(folder, "zarr.json", files);
  if (!of_version_3.is_null()) {
    ZarrNode node{of_version_3.at("node_type") == "array", of_version_3.value("attributes", json()),
                  of_version_3.value("dimension_names", json())};
    // Since version 0.5, OME-Zarr's metadata is inside one attribute.
    if (node.attributes.is_object() && node.attributes.contains("ome") &&
        node.attributes.at("ome").is_object()) {
      node.attributes = json(node.attributes.at("ome"));
      check_version(node.attributes.value("version", json()), folder);
    }
    return node;
  }
  const bool is_array = open_file_if_there(path_in(folder, ".zarray"), files) != nullptr;
  if (!is_array && !open_file_if_there(path_in(folder, ".zgroup"), files)) return std::nullopt;
  ZarrNode node{is_array, is_array ? attributes_of_array(folder, files) : json_in(folder, ".zattrs", files),
                json()};
  if (node.attributes.is_object()) node.dimension_names = node.attributes.value("_ARRAY_DIMENSIONS", json());
  return node;
}

bool is_image(const ZarrNode& node) {
  return node.attributes.is_object() && node.attributes.contains("multiscales");
}

/// The axes of an array that is not an image: by its dimension names, or the last of t, c, z, y, x.
std::vector<ZarrAxis> axes_of_array(const json& dimension_names, std::size_t count, const std::string& folder) {
  // Version 3 has null for dimensions without a name: if any is unnamed, all names are ignored.
  const bool have_names =
      dimension_names.is_array() && !dimension_names.empty() &&
      std::ranges::none_of(dimension_names, [](const json& name) { return name.is_null(); });
  if (have_names) {
    std::vector<ZarrAxis> axes;
    for (const json& name : dimension_names) {
      const std::optional<ZarrAxis> axis = axis_named(name.get<std::string>());
      if (!axis || axes.size() >= most_zarr_axes)
        fail_zarr(folder,
                  fmt::format("it has a dimension '{}'; up to {} are read, of the names t, c, z, y and x",
                              name.get<std::string>(), most_zarr_axes));
      axes.push_back(*axis);
    }
    return axes;
  }
  std::vector<ZarrAxis> axes{ZarrAxis::time, ZarrAxis::channel, ZarrAxis::z, ZarrAxis::y, ZarrAxis::x};
  axes.erase(axes.begin(), axes.end() - std::ptrdiff_t(std::min(count, axes.size())));
  if (count == 4) axes.front() = ZarrAxis::time;  // as in files of other formats
  return axes;
}

/// The image of which the array in `folder` is a level, because such an array does not specify its axes. Empty
/// if there is none.
std::string image_above(const std::string& folder, const ReadableFiles& files) {
  std::filesystem::path path = std::filesystem::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  while (path.has_relative_path()) {
    path = path.parent_path();
    try {
      const std::optional<ZarrNode> node = node_in(path.string(), files);
      if (!node) return {};
      if (is_image(*node)) return path.string();
    } catch (const FileError&) {
      return {};  // it may lie where files must not be read
    }
  }
  return {};
}

/// A packing attribute of climate models and microscopes (CF conventions).
double number_in(const json& attributes, const char* name, double otherwise) {
  if (!attributes.is_object() || !attributes.contains(name) || !attributes.at(name).is_number())
    return otherwise;
  const double number = attributes.at(name).get<double>();
  return std::isfinite(number) ? number : otherwise;
}

}  // namespace

bool is_zarr(const std::string& folder, const ReadableFiles& files) {
  return std::ranges::any_of(std::array{".zarray", ".zgroup", "zarr.json"}, [&](const char* name) {
    return open_file_if_there(path_in(folder, name), files) != nullptr;
  });
}

ZarrImage zarr_image(const std::string& folder, int level, const ReadableFiles& files) {
  return with_json(folder, [&]() -> ZarrImage {
    const ZarrNode node = node_in(folder, files).value_or(ZarrNode{});
    if (is_image(node)) return image_of(node.attributes.at("multiscales").at(0), folder, level, files);
    if (!node.is_array)
      fail_zarr(folder,
                "it is a group without an image; give an array or an OME-Zarr image in it, such as the folder "
                "0, or A/1/0 of "
                "a plate");
    if (level != 0) fail_zarr(folder, fmt::format("an array alone has no level {}; leave out --level", level));
    if (const std::string image = image_above(folder, files); !image.empty())
      fail_zarr(folder, fmt::format("it is a level of the image {}; give that folder, and --level", image));
    ZarrImage image;
    image.folder = folder;
    image.axes = axes_of_array(node.dimension_names, zarr_array(folder, files).shape.size(), folder);
    image.scale = number_in(node.attributes, "scale_factor", 1);
    image.offset = number_in(node.attributes, "add_offset", 0);
    return image;
  });
}

}  // namespace understudy::volume
