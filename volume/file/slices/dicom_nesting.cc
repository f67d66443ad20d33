// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/dicom_nesting.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace understudy::volume {

namespace {

constexpr std::uint32_t undefined_length = 0xFFFFFFFF, item = 0xFFFEE000, item_ends = 0xFFFEE00D,
                        sequence_ends = 0xFFFEE0DD, pixel_data = 0x7FE00010;
constexpr std::uint64_t no_end = std::numeric_limits<std::uint64_t>::max(), mark_end = 132;

/// Random access to bytes, buffered.
class Window {
 public:
  explicit Window(ByteSource& file) : file_(file) {}

  /// Zeros after the end of the file.
  std::array<std::uint8_t, 12> at(std::uint64_t place) {
    std::array<std::uint8_t, 12> bytes{};
    if (place < first_ || place + bytes.size() > first_ + filled_) {
      first_ = place;
      filled_ = file_.read(place, std::as_writable_bytes(std::span(part_)));
    }
    const std::size_t here = std::size_t(place - first_),
                      there = std::min(bytes.size(), filled_ - std::min(here, filled_));
    std::copy_n(part_.begin() + std::ptrdiff_t(here), there, bytes.begin());
    return bytes;
  }

 private:
  ByteSource& file_;
  std::array<std::uint8_t, std::size_t(1) << 14> part_{};
  std::uint64_t first_ = 0;
  std::size_t filled_ = 0;
};

struct Syntax {
  bool explicit_types = false;
  bool big_endian = false;
};

/// One element or delimiter.
struct Element {
  std::uint32_t tag = 0;
  std::uint32_t length = 0;
  std::size_t header_bytes = 8;
  bool is_sequence = false;
  bool is_unknown = false;  ///< of type UN, inside which value representations are implicit
};

std::uint32_t number(std::span<const std::uint8_t> bytes, bool big_endian) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    value = value << 8 | bytes[big_endian ? i : bytes.size() - 1 - i];
  return value;
}

bool is_type(std::uint8_t a, std::uint8_t b) {
  return a >= 'A' && a <= 'Z' && b >= 'A' && b <= 'Z';
}

/// Empty if the value representation is not one of DICOM's: readers would guess its length.
std::optional<Element> element_at(Window& window, std::uint64_t place, const Syntax& syntax) {
  const std::array<std::uint8_t, 12> bytes = window.at(place);
  const auto part = [&](std::size_t first, std::size_t count) {
    return number(std::span(bytes).subspan(first, count), syntax.big_endian);
  };
  Element found;
  found.tag = part(0, 2) << 16 | part(2, 2);
  found.length = part(4, 4);
  const bool is_delimiter = found.tag == item || found.tag == item_ends || found.tag == sequence_ends;
  if (is_delimiter) return found;
  if (syntax.explicit_types) {
    const std::string type{char(bytes[4]), char(bytes[5])};
    constexpr std::string_view long_types = "OB OD OF OL OV OW SQ SV UC UN UR UT UV",
                               short_types = "AE AS AT CS DA DS DT FD FL IS LO LT PN SH SL SS ST TM UI UL US";
    if (!is_type(bytes[4], bytes[5]) ||
        (long_types.find(type) == std::string_view::npos && short_types.find(type) == std::string_view::npos))
      return std::nullopt;
    const bool is_long = long_types.find(type) != std::string_view::npos;
    found.length = is_long ? part(8, 4) : part(6, 2);
    found.header_bytes = is_long ? 12 : 8;
    found.is_sequence = type == "SQ";
    found.is_unknown = type == "UN";
  }
  // The value representation may be unknown; sequences begin with an item.
  if (found.length == undefined_length) found.is_sequence = true;
  if (!found.is_sequence && found.length >= 8) {
    const std::array<std::uint8_t, 12> value = window.at(place + found.header_bytes);
    const std::uint32_t first = number(std::span(value).first(2), syntax.big_endian) << 16 |
                                number(std::span(value).subspan(2, 2), syntax.big_endian);
    found.is_sequence = first == item;
  }
  return found;
}

/// The transfer syntax of the elements after group 2, which specifies it and is skipped.
std::optional<Syntax> syntax_behind_meta_information(Window& window, std::uint64_t& place) {
  constexpr std::uint32_t syntax_uid = 0x00020010, longest_uid = 64;
  constexpr std::string_view deflated = "1.2.840.10008.1.2.1.99";
  const Syntax meta{.explicit_types = true, .big_endian = false};
  std::string uid;
  for (;;) {
    const std::optional<Element> found = element_at(window, place, meta);
    if (!found || found->tag >> 16 != 2) break;
    if (found->is_sequence) return std::nullopt;  // group 2 has no sequences
    if (found->tag == syntax_uid)
      for (std::uint32_t i = 0; i < std::min(found->length, longest_uid); ++i)
        if (const std::uint8_t c = window.at(place + found->header_bytes + i)[0]; c != 0 && c != ' ')
          uid += char(c);
    place += found->header_bytes + found->length;
  }
  if (uid == deflated) place = no_end;  // the file is refused elsewhere
  // Without meta information, the first element determines it.
  const std::array<std::uint8_t, 12> first =
      place == no_end ? std::array<std::uint8_t, 12>{} : window.at(place);
  const bool looks_explicit = is_type(first[4], first[5]);
  return Syntax{.explicit_types = uid.empty() ? looks_explicit : uid != "1.2.840.10008.1.2",
                .big_endian = uid == "1.2.840.10008.1.2.2"};
}

}  // namespace

bool sequences_nest_within(ByteSource& file, int most) {
  constexpr int most_elements = 20'000'000;
  Window window(file);
  const std::array<std::uint8_t, 12> mark = window.at(mark_end - 4);
  std::uint64_t place =
      std::string_view(reinterpret_cast<const char*>(mark.data()), 4) == "DICM" ? mark_end : 0;
  const std::optional<Syntax> syntax = syntax_behind_meta_information(window, place);
  if (!syntax) return false;
  const std::uint64_t size = file.size().value_or(0);
  struct Open {
    std::uint64_t end;
    Syntax syntax;
  };
  std::vector<Open> open;  // sequences and items
  for (int i = 0; place < size; ++i) {
    while (!open.empty() && open.back().end <= place) open.pop_back();
    const Syntax here = open.empty() ? *syntax : open.back().syntax;
    const std::optional<Element> found = element_at(window, place, here);
    if (!found || i > most_elements) return false;
    if (found->tag == pixel_data && open.empty()) return true;
    place += found->header_bytes;
    if (found->tag == item_ends || found->tag == sequence_ends) {
      if (!open.empty()) open.pop_back();
    } else if (found->is_sequence || found->tag == item) {
      const Syntax within = found->is_unknown ? Syntax{} : here;
      open.push_back({found->length == undefined_length ? no_end : place + found->length, within});
      if (open.size() > 2 * std::size_t(most)) return false;
    } else {
      place += found->length;
    }
  }
  return true;
}

}  // namespace understudy::volume
