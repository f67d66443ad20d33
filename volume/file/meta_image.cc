// SPDX-License-Identifier: Apache-2.0
#include "volume/file/meta_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <string_view>
#include <vector>

#include "volume/file/file_error.h"
#include "volume/file/gzip_source.h"
#include "volume/file/header_fields.h"

namespace understudy::volume {

namespace {

// Ultrasound sequences (PLUS) have several header lines per frame.
constexpr std::size_t most_header_bytes = std::size_t(1) << 22;
constexpr std::size_t header_part_bytes = std::size_t(1) << 16;
constexpr std::int64_t most_skipped = std::int64_t(1) << 40;
constexpr std::size_t most_axes = 4;

bool is_true(const std::string& flag) {
  return !flag.empty() && (flag[0] == 'T' || flag[0] == 't' || flag[0] == '1');
}

struct MetaImageHeader {
  HeaderFields fields;
  std::uint64_t bytes = 0;  ///< including the last line's end

  std::vector<std::string> words(const char* name) const { return words_of(fields.text(name), most_axes); }

  bool big_endian() const {
    const std::string binary = fields.text("BinaryDataByteOrderMSB");
    return is_true(binary.empty() ? fields.text("ElementByteOrderMSB") : binary);
  }
};

/// Parses lines "name = value". The last one names the data, which may follow it directly.
MetaImageHeader header_of(ByteSource& file) {
  MetaImageHeader header{HeaderFields("MetaImage", file.path())};
  std::string text;
  std::size_t at = 0;
  for (bool more = true; more || at < text.size();) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos && more) {
      if (text.size() >= most_header_bytes)
        header.fields.fail(
            fmt::format("its header does not end within {} bytes; get the file again", most_header_bytes));
      std::array<char, header_part_bytes> part{};
      const std::size_t got = file.read(text.size(), std::as_writable_bytes(std::span(part)));
      text.append(part.data(), got);
      more = got == part.size();
      continue;
    }
    const std::string_view line = std::string_view(text).substr(at, std::min(end, text.size()) - at);
    at = end == std::string::npos ? text.size() : end + 1;
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string name = trimmed(line.substr(0, equals));
    header.fields.add(name, trimmed(line.substr(equals + 1)));
    if (name != "ElementDataFile") continue;
    header.bytes = at;
    return header;
  }
  header.fields.fail("its header has no field 'ElementDataFile'; get the file again");
}

/// MetaIO's long has 32 bits on every machine.
ScalarType type_of(const MetaImageHeader& header) {
  static const std::map<std::string, ScalarType> names{
      {"MET_CHAR", ScalarType::i8},        {"MET_UCHAR", ScalarType::u8},  {"MET_SHORT", ScalarType::i16},
      {"MET_USHORT", ScalarType::u16},     {"MET_INT", ScalarType::i32},   {"MET_UINT", ScalarType::u32},
      {"MET_LONG", ScalarType::i32},       {"MET_ULONG", ScalarType::u32}, {"MET_LONG_LONG", ScalarType::i64},
      {"MET_ULONG_LONG", ScalarType::u64}, {"MET_FLOAT", ScalarType::f32}, {"MET_DOUBLE", ScalarType::f64}};
  const std::string channels = header.fields.text("ElementNumberOfChannels");
  const auto found = names.find(header.fields.text("ElementType"));
  if (found == names.end() || (!channels.empty() && channels != "1"))
    header.fields.fail(
        fmt::format("elements of type '{}' and {} channels are no scalars that can be drawn; "
                    "extract one component first",
                    header.fields.text("ElementType"), channels.empty() ? "1" : channels));
  return found->second;
}

FileDescription description_of(const MetaImageHeader& header, const std::string& path) {
  const std::vector<std::string> lengths = header.words("DimSize");
  const auto axes =
      std::size_t(header.fields.integer("NDims", header.fields.required("NDims"), 2, std::int64_t(most_axes)));
  if (lengths.size() != axes)
    header.fields.fail(fmt::format("it has {} axes but {} sizes; check its header", axes, lengths.size()));
  // ElementSize is the size of a detector element, and is used if the spacing is not specified.
  std::vector<std::string> spacing = header.words("ElementSpacing");
  if (spacing.empty()) spacing = header.words("ElementSize");
  std::array<std::int64_t, most_axes> size{1, 1, 1, 1};
  FileDescription description;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    size[axis] = header.fields.integer("DimSize", lengths[axis], 0, std::numeric_limits<std::int64_t>::max());
    if (axis < 3 && axis < spacing.size())
      description.spacing[axis] = believable_spacing(std::strtod(spacing[axis].c_str(), nullptr));
  }
  description.type = type_of(header);
  checked_bytes({size[0], size[1], size[2]}, description.type, path);
  for (std::size_t axis = 0; axis < 3; ++axis) description.size[axis] = int(size[axis]);
  description.time_steps = checked_time_steps(size[3], path);
  return description;
}

/// Finds the scalars of all time steps: in the file itself, or in another one next to it.
DenseScalars scalars_of(const MetaImageHeader& header, std::unique_ptr<ByteSource> file,
                        const ReadableFiles& files) {
  DenseScalars scalars;
  scalars.advice = "its header and its data do not belong together: get the file again";
  scalars.big_endian = header.big_endian();
  const std::string data = header.fields.text("ElementDataFile");
  if (data == "LOCAL" || data == "Local" || data == "local") {
    scalars.offset = header.bytes;
  } else {
    if (data.empty() || data.starts_with("LIST") || data.find('%') != std::string::npos)
      header.fields.fail("its data lies in several files; join them first");
    file = open_file(std::filesystem::path(file->path()).parent_path() / data, files);
  }
  // HeaderSize is counted from the beginning of the file, even if the file has a header.
  const std::string skip_text = header.fields.text("HeaderSize");
  const std::int64_t skip =
      skip_text.empty() ? 0 : header.fields.integer("HeaderSize", skip_text, -1, most_skipped);
  if (skip > 0 && std::uint64_t(skip) < scalars.offset)
    header.fields.fail(fmt::format("its HeaderSize is {}, but its header has {} bytes; check its header", skip,
                                   scalars.offset));
  if (skip > 0) scalars.offset = std::uint64_t(skip);
  if (is_true(header.fields.text("CompressedData"))) {
    if (skip < 0) header.fields.fail("a HeaderSize of -1 means nothing of compressed data; check its header");
    scalars.bytes = std::make_unique<GzipSource>(std::move(file), scalars.offset);
    scalars.offset = 0;
    return scalars;
  }
  scalars.at_end = skip < 0;
  scalars.bytes = std::move(file);
  return scalars;
}

}  // namespace

bool is_meta_image(const std::string& path) {
  return has_extension(path, ".mha") || has_extension(path, ".mhd");
}

std::unique_ptr<VolumeFile> open_meta_image(const std::string& path, int time_step,
                                            const ReadableFiles& files) {
  std::unique_ptr<ByteSource> file = open_file(path, files);
  const MetaImageHeader header = header_of(*file);
  if (const std::string object = header.fields.text("ObjectType"); !object.empty() && object != "Image")
    header.fields.fail(fmt::format("it holds a '{}', not an image; give another file", object));
  if (const std::string binary = header.fields.text("BinaryData"); !binary.empty() && !is_true(binary))
    header.fields.fail("its data is text; save it as binary data");
  const FileDescription description = description_of(header, path);
  DenseScalars scalars = scalars_of(header, std::move(file), files);
  scalars.time_step = time_step;
  return dense_volume(description, std::move(scalars));
}

}  // namespace understudy::volume
