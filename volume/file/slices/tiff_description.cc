// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/tiff_description.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <vector>

#include "volume/file/file_error.h"
#include "volume/file/header_fields.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

namespace {

using Fields = std::map<std::string, std::string, std::less<>>;

std::optional<double> number_of(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end()) return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(found->second.c_str(), &end);
  return end == found->second.c_str() ? std::nullopt : std::optional(number);
}

std::int64_t count_of(const Fields& fields, std::string_view name, const std::string& path) {
  constexpr double most = 1 << 20;
  const double count = number_of(fields, name).value_or(1);
  if (!(count >= 1 && count <= most) || count != double(std::int64_t(count)))
    fail_tiff(path, fmt::format("its description speaks of {} = {}; get the file again", name, count));
  return std::int64_t(count);
}

/// Parses lines "name=value", as written by ImageJ's FileSaver; missing counts are 1.
TiffDescription from_imagej(const std::string& text, const std::string& path) {
  Fields fields;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = std::string_view(text).substr(at, end - at);
    if (const std::size_t equals = line.find('='); equals != std::string_view::npos)
      fields[trimmed(line.substr(0, equals))] = trimmed(line.substr(equals + 1));
    at = end + 1;
  }
  TiffDescription found;
  found.by_imagej = true;
  found.channels = count_of(fields, "channels", path);
  found.time_steps = count_of(fields, "frames", path);
  // A stack that is not a hyperstack specifies only its number of images.
  const bool is_hyperstack =
      fields.contains("slices") || fields.contains("frames") || fields.contains("channels");
  found.slices = count_of(fields, is_hyperstack ? "slices" : "images", path);
  found.channel_stride = 1;
  found.slice_stride = found.channels;
  found.step_stride = found.channels * found.slices;
  found.spacing[2] = believable_spacing(number_of(fields, "spacing").value_or(1));
  return found;
}

/// The attributes of the first element "Pixels", and of its elements that assign planes to pages.
struct OmePixels {
  bool there = false;
  bool ended = false;  ///< subsequent elements belong to other images
  bool out_of_memory = false;
  Fields fields;
  std::vector<Fields> pages;
};

OmePixels pixels_of(const std::string& text, const std::string& path) {
  OmePixels found;
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                            &XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  XML_SetUserData(parser.get(), &found);
  XML_SetStartElementHandler(parser.get(), [](void* user, const char* name, const char** words) {
    auto* const pixels = static_cast<OmePixels*>(user);
    const std::string_view whole(name), element = whole.substr(whole.rfind(':') + 1);
    try {  // no exception may propagate through expat
      Fields* to = nullptr;
      if (element == "Pixels" && !pixels->there) to = &pixels->fields;
      if (element == "TiffData" && pixels->there && !pixels->ended) to = &pixels->pages.emplace_back();
      pixels->there = pixels->there || element == "Pixels";
      for (; to != nullptr && *words != nullptr; words += 2) (*to)[words[0]] = words[1];
    } catch (const std::bad_alloc&) {
      pixels->out_of_memory = true;
    }
  });
  XML_SetEndElementHandler(parser.get(), [](void* user, const char* name) {
    const std::string_view whole(name);
    if (whole.substr(whole.rfind(':') + 1) == "Pixels") static_cast<OmePixels*>(user)->ended = true;
  });
  if (XML_Parse(parser.get(), text.data(), int(text.size()), XML_TRUE) == XML_STATUS_ERROR && !found.there)
    fail_tiff(path, fmt::format("its OME description is damaged: {}; get the file again",
                                XML_ErrorString(XML_GetErrorCode(parser.get()))));
  if (found.out_of_memory) throw std::bad_alloc();
  return found;
}

/// In metres; unknown units are treated as micrometres, OME's default.
double unit_of(const Fields& fields, const std::string& axis) {
  static const std::map<std::string, double> units{{"nm", 1e-9}, {"µm", 1e-6}, {"um", 1e-6},
                                                   {"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}};
  const auto found = fields.find(axis + "Unit");
  const auto unit = found == fields.end() ? units.end() : units.find(found->second);
  return unit == units.end() ? 1e-6 : unit->second;
}

TiffDescription from_ome(const std::string& text, const std::string& path) {
  const OmePixels pixels = pixels_of(text, path);
  const Fields& fields = pixels.fields;
  TiffDescription found;
  found.slices = count_of(fields, "SizeZ", path);
  found.time_steps = count_of(fields, "SizeT", path);
  found.channels = count_of(fields, "SizeC", path);
  // "XYZCT" or another order of the last three axes, fastest first.
  const auto told = fields.find("DimensionOrder");
  const std::string order = told == fields.end() ? "XYZCT" : told->second;
  std::int64_t stride = 1;
  for (const char axis : order) {
    if (axis == 'Z') {
      found.slice_stride = stride;
      stride *= found.slices;
    } else if (axis == 'T') {
      found.step_stride = stride;
      stride *= found.time_steps;
    } else if (axis == 'C') {
      found.channel_stride = stride;
      stride *= found.channels;
    }
  }
  if (stride != found.images())
    fail_tiff(path, fmt::format("its OME description has the order '{}'; get the file again", order));
  for (const Fields& page : pixels.pages) {
    if (!page.contains("IFD")) continue;
    const auto number = [&](std::string_view name) { return number_of(page, name).value_or(0); };
    const double expected = number("FirstZ") * double(found.slice_stride) +
                            number("FirstT") * double(found.step_stride) +
                            number("FirstC") * double(found.channel_stride);
    if (number("IFD") != expected)
      fail_tiff(path,
                fmt::format("its page {} holds what should be in page {}: such an order is not read; write it "
                            "again as OME-TIFF",
                            number("IFD"), expected));
  }
  const std::array<std::string, 3> axes{"PhysicalSizeX", "PhysicalSizeY", "PhysicalSizeZ"};
  const bool all_told =
      std::ranges::all_of(axes, [&](const std::string& axis) { return fields.contains(axis); });
  for (std::size_t axis = 0; all_told && axis < 3; ++axis)
    found.spacing[axis] = believable_spacing(number_of(fields, axes[axis]).value_or(1) *
                                             unit_of(fields, axes[axis]) / unit_of(fields, axes[0]));
  return found;
}

}  // namespace

void fail_tiff(const std::string& path, const std::string& what) {
  throw FileError(fmt::format("{}: TIFF: {}", path, what));
}

TiffDescription tiff_description(const std::string& text, const std::string& path) {
  if (text.starts_with("ImageJ=")) return from_imagej(text, path);
  if (text.find("<OME") != std::string::npos) return from_ome(text, path);
  return {};
}

}  // namespace understudy::volume
