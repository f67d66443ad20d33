// SPDX-License-Identifier: Apache-2.0
#include "volume/file/vti_header.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <exception>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

constexpr std::size_t part_bytes = std::size_t(1) << 16;
/// Most text without a tag or other event; expat would keep all of it, and no header needs more.
constexpr std::uint64_t longest_silence = std::uint64_t(1) << 22;

struct DataArray {
  std::string name;
  std::string type;
  std::string format;
  std::int64_t components = 1;
  std::uint64_t at = 0;  ///< appended: relative to the underscore; inline: of the text, in the file
};

/// The scalars of points or cells.
struct Section {
  std::string active;  ///< name of the active scalars
  std::vector<DataArray> arrays;

  const DataArray* chosen() const {
    const auto found = std::ranges::find_if(arrays, [&](const DataArray& array) {
      return array.components == 1 && (active.empty() || array.name == active);
    });
    return found == arrays.end() ? nullptr : &*found;
  }
};

using Attributes = std::map<std::string, std::string>;

class HeaderParser {
 public:
  explicit HeaderParser(ByteSource& file) : file_(file), parser_(XML_ParserCreate(nullptr)) {
    if (parser_ == nullptr) throw std::bad_alloc();
    XML_SetUserData(parser_, this);
    XML_SetElementHandler(
        parser_,
        [](void* self, const char* name, const char** words) {
          static_cast<HeaderParser*>(self)->guarded(
              [&] { static_cast<HeaderParser*>(self)->begin(name, words); });
        },
        [](void* self, const char* name) {
          static_cast<HeaderParser*>(self)->guarded([&] { static_cast<HeaderParser*>(self)->end(name); });
        });
    XML_SetCharacterDataHandler(parser_, [](void* self, const char*, int) {
      auto* const header = static_cast<HeaderParser*>(self);
      header->last_event_ = header->fed_;
    });
  }
  HeaderParser(const HeaderParser&) = delete;
  HeaderParser& operator=(const HeaderParser&) = delete;
  ~HeaderParser() { XML_ParserFree(parser_); }

  VtiHeader read() {
    std::vector<char> part(part_bytes);
    while (!complete_) {
      const std::size_t got = file_.read(fed_, std::as_writable_bytes(std::span(part)));
      fed_ += got;
      if (fed_ - last_event_ > longest_silence) fail("a tag does not end; get the file again");
      const bool last = got < part.size();
      const XML_Status status = XML_Parse(parser_, part.data(), int(got), last ? XML_TRUE : XML_FALSE);
      if (!trouble_.empty()) fail(trouble_);
      if (complete_) break;
      if (status == XML_STATUS_ERROR)
        fail(fmt::format("{} in line {}; get the file again", XML_ErrorString(XML_GetErrorCode(parser_)),
                         XML_GetCurrentLineNumber(parser_)));
      if (last) break;
    }
    return result();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(fmt::format("{}: not a readable VTK image file: {}", file_.path(), what));
  }

  /// Prevents exceptions from propagating through expat.
  template <class Call>
  void guarded(Call call) {
    last_event_ = fed_;
    try {
      call();
    } catch (const std::exception& error) {
      trouble_ = error.what();
    }
    if (complete_ || !trouble_.empty()) XML_StopParser(parser_, XML_FALSE);
  }

  [[noreturn]] static void refuse(const std::string& what) { throw std::runtime_error(what); }

  static std::string text(const Attributes& attributes, const char* name, const char* otherwise = "") {
    const auto found = attributes.find(name);
    return found == attributes.end() ? otherwise : found->second;
  }

  static std::int64_t integer(const std::string& value, const char* name) {
    std::int64_t number = 0;
    const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || stop != value.data() + value.size() || number < 0)
      refuse(fmt::format("{} is '{}', not a number; get the file again", name, value));
    return number;
  }

  static std::array<std::int64_t, 6> extent(const std::string& value) {
    std::array<std::int64_t, 6> extent{};
    std::istringstream words(value);
    for (std::int64_t& number : extent)
      if (!(words >> number) || std::abs(number) > std::int64_t(1) << 40)
        refuse(fmt::format("its extent is '{}', not six numbers; get the file again", value));
    return extent;
  }

  void begin(const std::string& name, const char** words) {
    Attributes attributes;
    for (; *words != nullptr; words += 2) attributes[words[0]] = words[1];
    if (name == "VTKFile") {
      begin_file(attributes);
    } else if (name == "ImageData") {
      whole_ = extent(text(attributes, "WholeExtent"));
      std::istringstream spacing(text(attributes, "Spacing", "1 1 1"));
      for (double& distance : header_.spacing)
        if (!(spacing >> distance)) distance = 1;
    } else if (name == "Piece") {
      if (++pieces_ > 1 || extent(text(attributes, "Extent")) != whole_)
        refuse("it holds a volume in pieces; write it as one piece");
    } else if (name == "PointData" || name == "CellData") {
      section_ = name == "PointData" ? &points_ : &cells_;
      section_->active = text(attributes, "Scalars");
    } else if (name == "DataArray" && section_ != nullptr) {
      begin_array(attributes);
    } else if (name == "AppendedData") {
      const std::string encoding = text(attributes, "encoding", "base64");
      if (encoding != "raw" && encoding != "base64")
        refuse(fmt::format("its appended data is encoded as '{}'; write it raw or in base64", encoding));
      header_.encoding = encoding == "raw" ? VtiHeader::Encoding::raw : VtiHeader::Encoding::base64;
      appended_at_ = behind_tag();
      complete_ = true;
    }
  }

  void end(const std::string& name) {
    if (name == "PointData" || name == "CellData") section_ = nullptr;
  }

  void begin_file(const Attributes& attributes) {
    if (const std::string type = text(attributes, "type"); type != "ImageData")
      refuse(fmt::format("it holds {}, not ImageData; resample it to an image first", type));
    const std::string order = text(attributes, "byte_order", "LittleEndian");
    if (order != "LittleEndian" && order != "BigEndian")
      refuse(fmt::format("its byte order is '{}'; get the file again", order));
    header_.big_endian = order == "BigEndian";
    const std::string length = text(attributes, "header_type", "UInt32");
    if (length != "UInt32" && length != "UInt64")
      refuse(fmt::format("its header type is '{}'; get the file again", length));
    header_.length_bytes = length == "UInt32" ? 4 : 8;
    const std::string compressor = text(attributes, "compressor");
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      refuse(fmt::format("it is compressed by {}; write it with the ZLib compressor or without", compressor));
    header_.compressed = !compressor.empty();
  }

  void begin_array(const Attributes& attributes) {
    DataArray array;
    array.name = text(attributes, "Name");
    array.type = text(attributes, "type");
    array.format = text(attributes, "format");
    array.components = integer(text(attributes, "NumberOfComponents", "1"), "the number of components");
    array.at = array.format == "appended" ? std::uint64_t(integer(text(attributes, "offset"), "an offset"))
                                          : behind_tag();
    section_->arrays.push_back(array);
    // Appended data may be far ahead, but inline data can be read at once.
    const DataArray* chosen = points_.chosen();
    complete_ = chosen != nullptr && chosen->format != "appended";
  }

  std::uint64_t behind_tag() const {
    return std::uint64_t(XML_GetCurrentByteIndex(parser_)) + std::uint64_t(XML_GetCurrentByteCount(parser_));
  }

  VtiHeader result() {
    const DataArray* array = points_.chosen();
    const bool of_cells = array == nullptr;
    if (of_cells) array = cells_.chosen();
    if (array == nullptr)
      fail("it has no scalars with one component; choose or compute some, and write them as the active ones");
    for (std::size_t axis = 0; axis < 3; ++axis)
      header_.size[axis] = whole_[2 * axis + 1] - whole_[2 * axis] + (of_cells ? 0 : 1);
    static const std::map<std::string, ScalarType> types{
        {"Int8", ScalarType::i8},    {"UInt8", ScalarType::u8},   {"Int16", ScalarType::i16},
        {"UInt16", ScalarType::u16}, {"Int32", ScalarType::i32},  {"UInt32", ScalarType::u32},
        {"Int64", ScalarType::i64},  {"UInt64", ScalarType::u64}, {"Float32", ScalarType::f32},
        {"Float64", ScalarType::f64}};
    const auto type = types.find(array->type);
    if (type == types.end())
      fail(fmt::format("its scalars of type '{}' cannot be drawn; convert them", array->type));
    header_.type = type->second;
    if (array->format == "appended") {
      if (!appended_at_) fail("its data is to be appended, but there is none; get the file again");
      header_.data_at = behind_mark(*appended_at_) + array->at;
    } else if (array->format == "binary") {
      header_.encoding = VtiHeader::Encoding::base64;
      header_.data_at = behind_space(array->at);
    } else {
      fail(fmt::format("its data is '{}'; write it as appended or binary data", array->format));
    }
    return header_;
  }

  /// The first byte from `at` on that is not white space.
  std::uint64_t behind_space(std::uint64_t at) {
    std::array<char, 256> text{};
    const std::size_t got = file_.read(at, std::as_writable_bytes(std::span(text)));
    const std::string_view seen(text.data(), got);
    const std::size_t first = seen.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) fail("there is no data where its header says; get the file again");
    return at + first;
  }

  std::uint64_t behind_mark(std::uint64_t at) {
    const std::uint64_t mark = behind_space(at);
    std::byte here{};
    file_.read(mark, {&here, 1});
    if (char(here) != '_') fail("its appended data does not begin with an underscore; get the file again");
    return mark + 1;
  }

  ByteSource& file_;
  XML_Parser parser_;
  std::uint64_t fed_ = 0;
  std::uint64_t last_event_ = 0;
  std::string trouble_;
  bool complete_ = false;
  VtiHeader header_;
  std::array<std::int64_t, 6> whole_{};
  int pieces_ = 0;
  Section points_, cells_;
  Section* section_ = nullptr;
  std::optional<std::uint64_t> appended_at_;
};

}  // namespace

VtiHeader read_vti_header(ByteSource& file) {
  return HeaderParser(file).read();
}

}  // namespace understudy::volume
