// SPDX-License-Identifier: Apache-2.0
#include "volume/file/nrrd.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "volume/file/file_error.h"
#include "volume/file/gzip_source.h"
#include "volume/file/header_fields.h"

namespace understudy::volume {

namespace {

constexpr std::size_t max_header_bytes = std::size_t(1) << 20;
constexpr std::size_t max_axes = 16;
constexpr std::uint64_t max_skip = std::uint64_t(1) << 40;

[[noreturn]] void fail_nrrd(const std::string& path, const std::string& what) {
  HeaderFields("NRRD", path).fail(what);
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

struct NrrdHeader {
  HeaderFields fields;
  std::uint64_t bytes = 0;  ///< including the empty line at its end
};

// A detached header may also end at the end of the file.
NrrdHeader read_header(ByteSource& file) {
  std::string text(std::min<std::size_t>(max_header_bytes, std::size_t(file.size().value_or(max_header_bytes))),
                   ' ');
  text.resize(file.read(0, std::as_writable_bytes(std::span(text))));
  NrrdHeader header{HeaderFields("NRRD", file.path())};
  bool ended = text.size() < max_header_bytes;
  std::size_t at = 0;
  for (bool first = true; at < text.size(); first = false) {
    const std::size_t end = text.find('\n', at);
    const std::string line = trimmed(std::string_view(text).substr(at, std::min(end, text.size()) - at));
    at = std::min(end, text.size() - 1) + 1;
    if (line.empty() && !first) {
      ended = true;
      break;
    }
    const std::size_t colon = line.find(':');
    if (first || line[0] == '#' || colon == std::string::npos || line.compare(colon, 2, ":=") == 0) continue;
    std::string name = lower(trimmed(std::string_view(line).substr(0, colon)));
    std::erase(name, ' ');
    header.fields.add(name, trimmed(std::string_view(line).substr(colon + 1)));
  }
  if (!ended)
    header.fields.fail(
        fmt::format("its header does not end within {} bytes; get the file again", max_header_bytes));
  header.bytes = at;
  return header;
}

ScalarType type_of(const HeaderFields& fields, const std::string& path) {
  const std::string name = lower(fields.required("type"));
  static const std::map<std::string, ScalarType> names{{"signed char", ScalarType::i8},
                                                       {"int8", ScalarType::i8},
                                                       {"int8_t", ScalarType::i8},
                                                       {"uchar", ScalarType::u8},
                                                       {"unsigned char", ScalarType::u8},
                                                       {"uint8", ScalarType::u8},
                                                       {"uint8_t", ScalarType::u8},
                                                       {"short", ScalarType::i16},
                                                       {"short int", ScalarType::i16},
                                                       {"signed short", ScalarType::i16},
                                                       {"signed short int", ScalarType::i16},
                                                       {"int16", ScalarType::i16},
                                                       {"int16_t", ScalarType::i16},
                                                       {"ushort", ScalarType::u16},
                                                       {"unsigned short", ScalarType::u16},
                                                       {"unsigned short int", ScalarType::u16},
                                                       {"uint16", ScalarType::u16},
                                                       {"uint16_t", ScalarType::u16},
                                                       {"int", ScalarType::i32},
                                                       {"signed int", ScalarType::i32},
                                                       {"int32", ScalarType::i32},
                                                       {"int32_t", ScalarType::i32},
                                                       {"uint", ScalarType::u32},
                                                       {"unsigned int", ScalarType::u32},
                                                       {"uint32", ScalarType::u32},
                                                       {"uint32_t", ScalarType::u32},
                                                       {"longlong", ScalarType::i64},
                                                       {"long long", ScalarType::i64},
                                                       {"long long int", ScalarType::i64},
                                                       {"signed long long", ScalarType::i64},
                                                       {"signed long long int", ScalarType::i64},
                                                       {"int64", ScalarType::i64},
                                                       {"int64_t", ScalarType::i64},
                                                       {"ulonglong", ScalarType::u64},
                                                       {"unsigned long long", ScalarType::u64},
                                                       {"unsigned long long int", ScalarType::u64},
                                                       {"uint64", ScalarType::u64},
                                                       {"uint64_t", ScalarType::u64},
                                                       {"float", ScalarType::f32},
                                                       {"double", ScalarType::f64}};
  const auto found = names.find(name);
  if (found == names.end())
    fail_nrrd(path,
              fmt::format("scalars of type '{}' cannot be drawn; convert them, for example with `unu convert`",
                          name));
  return found->second;
}

/// Parses "(0.5,0,0) (0,0.5,0) none" as lengths; "none" becomes NaN.
std::vector<double> lengths_of(const std::string& directions) {
  std::vector<double> lengths;
  for (std::size_t at = 0; at < directions.size() && lengths.size() <= max_axes;) {
    if (directions.compare(at, 4, "none") == 0) {
      lengths.push_back(std::numeric_limits<double>::quiet_NaN());
      at += 4;
    } else if (directions[at] == '(') {
      const std::size_t end = std::min(directions.find(')', at), directions.size());
      std::string inner = directions.substr(at + 1, end - at - 1);
      std::ranges::replace(inner, ',', ' ');
      double square = 0;
      for (const std::string& word : words_of(inner, max_axes))
        square += std::pow(std::strtod(word.c_str(), nullptr), 2);
      lengths.push_back(std::sqrt(square));
      at = end + 1;
    } else {
      ++at;
    }
  }
  return lengths;
}

struct Axis {
  std::int64_t extent = 1;
  double spacing = 1;
  bool is_time = false;        ///< according to its kind
  bool may_be_space = true;    ///< according to its kind, or without one
  bool has_direction = false;  ///< in space
};

std::vector<Axis> axes_of(const HeaderFields& fields) {
  const auto count =
      std::size_t(fields.integer("dimension", fields.required("dimension"), 1, std::int64_t(max_axes)));
  const std::vector<std::string> sizes = words_of(fields.required("sizes"), max_axes);
  if (sizes.size() != count)
    fields.fail(fmt::format("it has {} axes but {} sizes; check its header", count, sizes.size()));
  std::vector<double> distances;
  const std::string directions = fields.text("spacedirections");
  if (!directions.empty())
    distances = lengths_of(directions);
  else
    for (const std::string& word : words_of(fields.text("spacings"), max_axes))
      distances.push_back(std::strtod(word.c_str(), nullptr));
  const std::vector<std::string> kinds = words_of(lower(fields.text("kinds")), max_axes);

  std::vector<Axis> axes(count);
  for (std::size_t k = 0; k < count; ++k) {
    axes[k].extent = fields.integer("sizes", sizes[k], 0, std::numeric_limits<std::int64_t>::max());
    if (k < distances.size()) axes[k].spacing = believable_spacing(distances[k]);
    const std::string kind = k < kinds.size() ? kinds[k] : "none";
    // 3D Slicer gives the axis of a time series the kind "list".
    axes[k].is_time = kind == "time" || kind == "list";
    axes[k].may_be_space = kind == "none" || kind == "???" || kind == "domain" || kind == "space";
    axes[k].has_direction = directions.empty() || (k < distances.size() && !std::isnan(distances[k]));
  }
  return axes;
}

struct TimeAxis {
  std::size_t place;
  bool is_fastest;
};

/// Finds the axis along which whole volumes follow each other, if any; for four or more axes.
std::optional<TimeAxis> time_axis(const std::vector<Axis>& axes, const HeaderFields& fields) {
  const Axis& last = axes.back();
  const std::size_t end = axes.size() - 1;
  if (last.is_time || (last.may_be_space && !last.has_direction)) return TimeAxis{end, false};
  if (axes.front().is_time) return TimeAxis{0, true};
  const auto is_long = [](const Axis& axis) { return axis.extent != 1; };
  if (std::ranges::count_if(axes, is_long) <= 3) return std::nullopt;
  for (std::size_t k = 1; k < end; ++k)
    if (axes[k].is_time && is_long(axes[k]))
      fields.fail(fmt::format(
          "its axis of time is number {} of {}; make it the last one, for example with `unu permute`", k + 1,
          axes.size()));
  const auto unmarked = [](const Axis& axis) { return axis.may_be_space && axis.has_direction; };
  if (!std::ranges::all_of(axes, unmarked)) return std::nullopt;
  if (axes.front().extent >= 2 && axes.front().extent <= 4)
    fields.fail(
        "its first axis may be one of components, or of time; say which by the field 'kinds', or cut it, for "
        "example "
        "with `unu slice`");
  return TimeAxis{end, false};
}

struct NrrdVolume {
  FileDescription description;
  bool steps_together = false;
};

NrrdVolume volume_of(const HeaderFields& fields, const std::string& path) {
  std::vector<Axis> axes = axes_of(fields);
  NrrdVolume volume;
  FileDescription& description = volume.description;
  while (axes.size() > 3 && axes.back().extent == 1) axes.pop_back();
  if (axes.size() > 3)
    if (const auto time = time_axis(axes, fields)) {
      description.time_steps = checked_time_steps(axes[time->place].extent, path);
      volume.steps_together = time->is_fastest && description.time_steps > 1;
      axes.erase(axes.begin() + std::ptrdiff_t(time->place));
    }
  if (axes.size() < 3)
    fields.fail(fmt::format("it has {} axes, a volume has 3; check its header", axes.size()));
  if (axes.size() > 3) std::erase_if(axes, [](const Axis& axis) { return axis.extent == 1; });
  if (axes.size() > 3)
    fields.fail("it has more than three axes longer than 1; cut it first, for example with `unu slice`");
  axes.resize(3);
  std::array<std::int64_t, 3> size{};
  for (std::size_t k = 0; k < 3; ++k) {
    size[k] = axes[k].extent;
    description.spacing[k] = axes[k].spacing;
  }
  description.type = type_of(fields, path);
  checked_bytes(size, description.type, path);
  for (std::size_t k = 0; k < 3; ++k) description.size[k] = int(size[k]);
  return volume;
}

std::uint64_t skip_lines(ByteSource& file, std::uint64_t from, std::int64_t lines) {
  std::vector<char> part(std::size_t(1) << 16);
  while (lines > 0) {
    const std::size_t got = file.read(from, std::as_writable_bytes(std::span(part)));
    if (got == 0)
      fail_nrrd(file.path(), "it has fewer lines than its header wants skipped; get the file again");
    for (std::size_t i = 0; i < got && lines > 0; ++i, ++from) lines -= part[i] == '\n';
  }
  return from;
}

}  // namespace

bool is_nrrd(const std::string& path, const ReadableFiles& files) {
  std::array<std::byte, 4> magic{};
  constexpr std::string_view wanted = "NRRD";
  return open_file(path, files)->read(0, magic) == magic.size() &&
         std::ranges::equal(magic, wanted, {}, [](std::byte b) { return char(b); });
}

std::unique_ptr<VolumeFile> open_nrrd(const std::string& path, int time_step, const ReadableFiles& files) {
  std::unique_ptr<ByteSource> file = open_file(path, files);
  const NrrdHeader header = read_header(*file);
  const HeaderFields& fields = header.fields;
  const NrrdVolume volume = volume_of(fields, path);

  DenseScalars scalars;
  scalars.offset = header.bytes;
  scalars.time_step = time_step;
  scalars.steps_together = volume.steps_together;
  scalars.advice = "its header and its data do not belong together: get the file again";
  std::string data = fields.text("datafile");
  if (!data.empty()) {
    if (data.starts_with("LIST") || data.find('%') != std::string::npos)
      fail_nrrd(path, "its data lies in several files; join them first, for example with `unu save -f nrrd`");
    // Relative to the header's folder, unless the name is absolute.
    file = open_file(std::filesystem::path(path).parent_path() / data, files);
    scalars.offset = 0;
  }
  if (const std::string lines = fields.text("lineskip"); !lines.empty())
    scalars.offset = skip_lines(*file, scalars.offset, fields.integer("line skip", lines, 0, 1 << 20));
  const std::string skip_text = fields.text("byteskip");
  const std::int64_t skip =
      skip_text.empty() ? 0 : fields.integer("byte skip", skip_text, -1, std::int64_t(max_skip));

  const std::string encoding = lower(fields.required("encoding"));
  if (encoding == "raw") {
    scalars.at_end = skip < 0;
    if (skip > 0) scalars.offset += std::uint64_t(skip);
    scalars.bytes = std::move(file);
  } else if (encoding == "gzip" || encoding == "gz") {
    if (skip < 0) fail_nrrd(path, "a byte skip of -1 means nothing in compressed data; check its header");
    scalars.bytes = std::make_unique<GzipSource>(std::move(file), scalars.offset);
    scalars.offset = std::uint64_t(skip);
  } else {
    fail_nrrd(path, fmt::format("its encoding '{}' is not read here; save it as raw or gzip, for example with "
                                "`unu save -f nrrd -e raw`",
                                encoding));
  }
  if (bytes_per_scalar(volume.description.type) > 1) {
    const std::string endian = lower(fields.required("endian"));
    if (endian != "little" && endian != "big")
      fail_nrrd(path, fmt::format("its field 'endian' is '{}', not little or big; check its header", endian));
    scalars.big_endian = endian == "big";
  }
  return dense_volume(volume.description, std::move(scalars));
}

}  // namespace understudy::volume
