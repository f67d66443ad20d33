// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/zarr_image.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "volume/cell_lattice.h"
#include "volume/file/byte_source.h"
#include "volume/file/chunks/zarr_array.h"
#include "volume/file/chunks/zarr_json.h"

namespace understudy::volume {

namespace {

using nlohmann::json;

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
  return path_in(folder, below.string());
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

/// What a folder says of itself.
struct ZarrNode {
  bool is_array = false;
  json attributes;       ///< null where it has none
  json dimension_names;  ///< of an array, likewise
};

/// Nothing where the folder has no metadata.
std::optional<ZarrNode> node_in(const std::string& folder, const ReadableFiles& files) {
  const json of_version_3 = json_in(folder, "zarr.json", files);
  if (!of_version_3.is_null()) {
    ZarrNode node{of_version_3.at("node_type") == "array", of_version_3.value("attributes", json()),
                  of_version_3.value("dimension_names", json())};
    // Since 0.5 what OME-Zarr says is within one attribute.
    if (node.attributes.is_object() && node.attributes.contains("ome"))
      node.attributes = json(node.attributes.at("ome"));
    return node;
  }
  const bool is_array = open_file_if_there(path_in(folder, ".zarray"), files) != nullptr;
  if (!is_array && !open_file_if_there(path_in(folder, ".zgroup"), files)) return std::nullopt;
  ZarrNode node{is_array, json_in(folder, ".zattrs", files), json()};
  if (node.attributes.is_object()) node.dimension_names = node.attributes.value("_ARRAY_DIMENSIONS", json());
  return node;
}

bool is_image(const ZarrNode& node) {
  return node.attributes.is_object() && node.attributes.contains("multiscales");
}

/// Of an array that is no image: as its names say, or the last of t, c, z, y, x.
std::vector<ZarrAxis> axes_of_array(const json& dimension_names, std::size_t count, const std::string& folder) {
  static const std::map<std::string, ZarrAxis> names{
      {"t", ZarrAxis::time}, {"time", ZarrAxis::time}, {"c", ZarrAxis::channel}, {"channel", ZarrAxis::channel},
      {"z", ZarrAxis::z},    {"y", ZarrAxis::y},       {"x", ZarrAxis::x}};
  // Version 3 has null for a dimension without a name.
  const bool have_names =
      dimension_names.is_array() &&
      std::ranges::any_of(dimension_names, [](const json& name) { return !name.is_null(); });
  if (have_names) {
    std::vector<ZarrAxis> axes;
    for (const json& name : dimension_names) {
      const std::string text = name.is_null() ? "" : name.get<std::string>();
      const auto found = names.find(text);
      if (found == names.end() || axes.size() >= most_zarr_axes)
        fail_zarr(folder, fmt::format("it has a dimension '{}'; t, c, z, y and x are read", text));
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
    return open_file_if_there(path_in(folder, name), files) != nullptr;
  });
}

ZarrImage zarr_image(const std::string& folder, int level, const ReadableFiles& files) {
  return with_json(folder, [&]() -> ZarrImage {
    const ZarrNode node = node_in(folder, files).value_or(ZarrNode{});
    if (is_image(node)) return image_of(node.attributes.at("multiscales").at(0), folder, level, files);
    if (!node.is_array)
      fail_zarr(
          folder,
          "it is a group without an image; give an array or an OME-Zarr image in it, such as the folder 0");
    if (level != 0) fail_zarr(folder, fmt::format("an array alone has no level {}; leave out --level", level));
    // An array of an image does not know its axes.
    const std::filesystem::path above = std::filesystem::path(folder).lexically_normal();
    const std::string parent = (above.has_filename() ? above : above.parent_path()).parent_path().string();
    if (const auto image = parent.empty() ? std::nullopt : node_in(parent, files); image && is_image(*image))
      fail_zarr(folder, fmt::format("it is a level of the image {}; give that folder, and --level", parent));
    ZarrImage image;
    image.folder = folder;
    image.axes = axes_of_array(node.dimension_names, zarr_array(folder, files).shape.size(), folder);
    return image;
  });
}

}  // namespace understudy::volume
