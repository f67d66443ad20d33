// SPDX-License-Identifier: Apache-2.0
#include "volume/file/nrrd.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <sstream>
#include <string_view>
#include <vector>

#include "volume/file/file_error.h"
#include "volume/file/gzip_source.h"

namespace understudy::volume {

namespace {

constexpr std::size_t max_header_bytes = std::size_t(1) << 20;
constexpr int max_axes = 16;
constexpr std::uint64_t max_skip = std::uint64_t(1) << 40;

struct NrrdHeader {
  std::map<std::string, std::string> fields;
  std::uint64_t bytes = 0;  ///< with the empty line at its end
};

[[noreturn]] void fail_nrrd(const std::string& path, const std::string& what) {
  throw FileError(fmt::format("{}: not a readable NRRD file: {}", path, what));
}

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

// Of a detached header the file's end ends it as well.
NrrdHeader read_header(ByteSource& file) {
  std::string text(std::min<std::size_t>(max_header_bytes, std::size_t(file.size().value_or(max_header_bytes))),
                   ' ');
  text.resize(file.read(0, std::as_writable_bytes(std::span(text))));
  NrrdHeader header;
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
    if (!header.fields.emplace(name, trimmed(std::string_view(line).substr(colon + 1))).second)
      fail_nrrd(file.path(), fmt::format("its header has the field '{}' twice; remove one", name));
  }
  if (!ended)
    fail_nrrd(file.path(),
              fmt::format("its header does not end within {} bytes; get the file again", max_header_bytes));
  header.bytes = at;
  return header;
}

class Fields {
 public:
  Fields(const NrrdHeader& header, const std::string& path) : fields_(header.fields), path_(path) {}

  /// Empty when there is none.
  std::string text(const char* name) const {
    const auto found = fields_.find(name);
    return found == fields_.end() ? std::string() : found->second;
  }
  std::string required(const char* name) const {
    std::string value = text(name);
    if (value.empty()) fail_nrrd(path_, fmt::format("its header has no field '{}'; get the file again", name));
    return value;
  }
  std::int64_t integer(const char* name, const std::string& value, std::int64_t low, std::int64_t high) const {
    std::int64_t number = 0;
    const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || stop != value.data() + value.size() || number < low || number > high)
      fail_nrrd(path_, fmt::format("its field '{}' is '{}', not a number of {} to {}; check its header", name,
                                   value, low, high));
    return number;
  }

 private:
  const std::map<std::string, std::string>& fields_;
  const std::string& path_;
};

ScalarType type_of(const Fields& fields, const std::string& path) {
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

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; int(words.size()) <= max_axes && stream >> word;) words.push_back(word);
  return words;
}

/// "(0.5,0,0) (0,0.5,0) none" as lengths; "none" is not a number.
std::vector<double> lengths_of(const std::string& directions) {
  std::vector<double> lengths;
  for (std::size_t at = 0; at < directions.size() && int(lengths.size()) <= max_axes;) {
    if (directions.compare(at, 4, "none") == 0) {
      lengths.push_back(std::numeric_limits<double>::quiet_NaN());
      at += 4;
    } else if (directions[at] == '(') {
      const std::size_t end = std::min(directions.find(')', at), directions.size());
      std::string inner = directions.substr(at + 1, end - at - 1);
      std::ranges::replace(inner, ',', ' ');
      double square = 0;
      for (const std::string& word : words_of(inner)) square += std::pow(std::strtod(word.c_str(), nullptr), 2);
      lengths.push_back(std::sqrt(square));
      at = end + 1;
    } else {
      ++at;
    }
  }
  return lengths;
}

FileDescription description_of(const Fields& fields, const std::string& path) {
  const auto axes = std::size_t(fields.integer("dimension", fields.required("dimension"), 1, max_axes));
  const std::vector<std::string> words = words_of(fields.required("sizes"));
  if (words.size() != axes)
    fail_nrrd(path, fmt::format("it has {} axes but {} sizes; check its header", axes, words.size()));
  std::vector<double> distances;
  if (const std::string directions = fields.text("spacedirections"); !directions.empty())
    distances = lengths_of(directions);
  else
    for (const std::string& word : words_of(fields.text("spacings")))
      distances.push_back(std::strtod(word.c_str(), nullptr));

  std::array<std::int64_t, 3> size{};
  FileDescription description;
  std::size_t spatial = 0;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const std::int64_t extent =
        fields.integer("sizes", words[axis], 0, std::numeric_limits<std::int64_t>::max());
    if (axes != 3 && extent == 1) continue;
    if (spatial == 3)
      fail_nrrd(path, "it has more than three axes longer than 1; cut it first, for example with `unu slice`");
    size[spatial] = extent;
    description.spacing[spatial++] = believable_spacing(axis < distances.size() ? distances[axis] : 1.0);
  }
  if (spatial < 3 && axes != 3) {
    if (axes < 3) fail_nrrd(path, fmt::format("it has {} axes, a volume has 3; check its header", axes));
    for (; spatial < 3; ++spatial) size[spatial] = 1;
  }
  description.type = type_of(fields, path);
  checked_bytes(size, description.type, path);
  for (std::size_t axis = 0; axis < 3; ++axis) description.size[axis] = int(size[axis]);
  return description;
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

std::unique_ptr<VolumeFile> open_nrrd(const std::string& path, const ReadableFiles& files) {
  std::unique_ptr<ByteSource> file = open_file(path, files);
  const NrrdHeader header = read_header(*file);
  const Fields fields(header, path);
  const FileDescription description = description_of(fields, path);

  DenseScalars scalars;
  scalars.offset = header.bytes;
  scalars.advice = "its header and its data do not belong together: get the file again";
  std::string data = fields.text("datafile");
  if (!data.empty()) {
    if (data.starts_with("LIST") || data.find('%') != std::string::npos)
      fail_nrrd(path, "its data lies in several files; join them first, for example with `unu save -f nrrd`");
    // Beside the header, unless the name is absolute.
    file = open_file(std::filesystem::path(path).parent_path() / data, files);
    scalars.offset = 0;
  }
  if (const std::string lines = fields.text("lineskip"); !lines.empty())
    scalars.offset = skip_lines(*file, scalars.offset, fields.integer("line skip", lines, 0, 1 << 20));
  const std::string skip_text = fields.text("byteskip");
  const std::int64_t skip =
      skip_text.empty() ? 0 : fields.integer("byte skip", skip_text, -1, std::int64_t(max_skip));

  const std::string encoding = lower(fields.required("encoding"));
  const std::uint64_t bytes =
      checked_bytes({description.size[0], description.size[1], description.size[2]}, description.type, path);
  if (encoding == "raw") {
    if (skip >= 0) {
      scalars.offset += std::uint64_t(skip);
    } else {  // the data is what the file ends with
      const std::uint64_t there = file->size().value_or(0);
      if (there < bytes)
        fail_nrrd(path, fmt::format("truncated: {} bytes of scalars were expected, {} are there; {}", bytes,
                                    there, scalars.advice));
      scalars.offset = there - bytes;
    }
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
  if (bytes_per_scalar(description.type) > 1) {
    const std::string endian = lower(fields.required("endian"));
    if (endian != "little" && endian != "big")
      fail_nrrd(path, fmt::format("its field 'endian' is '{}', not little or big; check its header", endian));
    scalars.big_endian = endian == "big";
  }
  return dense_volume(description, std::move(scalars));
}

}  // namespace understudy::volume
