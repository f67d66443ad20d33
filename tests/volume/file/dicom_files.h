// SPDX-License-Identifier: Apache-2.0
// Writes DICOM files (part 10 of the standard) without a library: explicit VR, little endian.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/volume/file/volume_files.h"

namespace understudy::volume::testing {

namespace dicom {

inline std::string little(std::uint64_t number, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += char(std::uint8_t(number >> (8 * i)));
  return text;
}

inline std::string element(unsigned group, unsigned number, const std::string& vr, std::string value) {
  if (value.size() % 2 != 0) value += vr == "UI" || vr == "OB" ? '\0' : ' ';
  const bool is_long = vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN";
  return little(group, 2) + little(number, 2) + vr +
         (is_long ? little(0, 2) + little(value.size(), 4) : little(value.size(), 2)) + value;
}

inline std::string number(unsigned group, unsigned name, unsigned value) {
  return element(group, name, "US", little(value, 2));
}

/// A sequence of items with these elements.
inline std::string sequence(unsigned group, unsigned name, const std::vector<std::string>& items) {
  std::string value;
  for (const std::string& item : items)
    value += little(0xFFFE, 2) + little(0xE000, 2) + little(item.size(), 4) + item;
  return element(group, name, "SQ", value);
}

inline std::string text_of(const std::vector<double>& numbers) {
  std::string text;
  for (const double one : numbers) text += (text.empty() ? "" : "\\") + std::to_string(one);
  return text;
}

}  // namespace dicom

/// Elements by group and number; they are written in this order.
using DicomElements = std::map<std::pair<unsigned, unsigned>, std::string>;

/// Settings of a DICOM file that a test may change.
struct DicomFile {
  std::array<int, 2> size{13, 7};
  ScalarType type = ScalarType::i16;
  int stored_bits = 0;  ///< 0: all bits of the type
  std::string series = "1.2.826.0.1.3680043.2.1125.1";
  std::string image;  ///< empty: derived from series, instance and position
  int instance = 1;
  std::vector<double> position{0, 0, 0};
  std::vector<double> orientation{1, 0, 0, 0, 1, 0};
  std::vector<double> pixel_spacing{0.5, 0.25};  ///< between rows, between columns
  double slope = 1;
  double intercept = 0;
  std::vector<std::vector<double>> frame_positions;  ///< for a file with several frames (Enhanced CT)
  unsigned samples = 1;
  std::string meaning = "MONOCHROME2";
  DicomElements more;
  Bytes pixels;
};

inline std::string dicom_bytes(const DicomFile& file) {
  using namespace dicom;
  const bool enhanced = !file.frame_positions.empty();
  const std::string kind = enhanced ? "1.2.840.10008.5.1.4.1.1.2.1" : "1.2.840.10008.5.1.4.1.1.2";
  const std::string image =
      !file.image.empty()
          ? file.image
          : file.series + "." + std::to_string(file.instance) + "." +
                std::to_string(file.position.empty() ? 0 : std::abs(std::llround(1000 * file.position[2])));
  const std::string meta = element(2, 1, "OB", std::string("\0\1", 2)) + element(2, 2, "UI", kind) +
                           element(2, 3, "UI", image) + element(2, 0x10, "UI", "1.2.840.10008.1.2.1");
  const unsigned bits = unsigned(bytes_per_scalar(file.type)) * 8;
  const unsigned stored = file.stored_bits != 0 ? unsigned(file.stored_bits) : bits;
  const bool with_sign =
      file.type == ScalarType::i8 || file.type == ScalarType::i16 || file.type == ScalarType::i32;
  DicomElements elements;
  const auto put = [&](unsigned group, unsigned name, const std::string& vr, const std::string& value) {
    elements[{group, name}] = element(group, name, vr, value);
  };
  const auto put_number = [&](unsigned name, unsigned value) { put(0x28, name, "US", little(value, 2)); };
  put(8, 0x16, "UI", kind);
  put(8, 0x18, "UI", image);
  put(8, 0x60, "CS", "CT");
  put(8, 0x103E, "LO", "head");
  put(0x18, 0x50, "DS", "5");
  put(0x20, 0xE, "UI", file.series);
  put(0x20, 0x11, "IS", "4");
  put(0x20, 0x13, "IS", std::to_string(file.instance));
  put_number(2, file.samples);
  put(0x28, 4, "CS", file.meaning);
  if (file.samples > 1) put_number(6, 0);
  put_number(0x10, unsigned(file.size[1]));
  put_number(0x11, unsigned(file.size[0]));
  put_number(0x100, bits);
  put_number(0x101, stored);
  put_number(0x102, stored - 1);
  put_number(0x103, with_sign ? 1 : 0);
  const std::string slope = element(0x28, 0x1053, "DS", std::to_string(file.slope)),
                    intercept = element(0x28, 0x1052, "DS", std::to_string(file.intercept));
  if (enhanced) {
    put(0x28, 8, "IS", std::to_string(file.frame_positions.size()));
    const std::string measures =
        element(0x18, 0x50, "DS", "5") + element(0x28, 0x30, "DS", text_of(file.pixel_spacing));
    elements[{0x5200, 0x9229}] =
        sequence(0x5200, 0x9229,
                 {sequence(0x20, 0x9116, {element(0x20, 0x37, "DS", text_of(file.orientation))}) +
                  sequence(0x28, 0x9110, {measures}) +
                  sequence(0x28, 0x9145, {intercept + slope + element(0x28, 0x1054, "LO", "HU")})});
    std::vector<std::string> frames;
    for (const std::vector<double>& position : file.frame_positions)
      frames.push_back(sequence(0x20, 0x9113, {element(0x20, 0x32, "DS", text_of(position))}));
    elements[{0x5200, 0x9230}] = sequence(0x5200, 0x9230, frames);
  } else {
    if (!file.position.empty()) {
      put(0x20, 0x32, "DS", text_of(file.position));
      put(0x20, 0x37, "DS", text_of(file.orientation));
    }
    put(0x28, 0x30, "DS", text_of(file.pixel_spacing));
    elements[{0x28, 0x1052}] = intercept;
    elements[{0x28, 0x1053}] = slope;
  }
  put(0x7FE0, 0x10, bits == 8 ? "OB" : "OW",
      std::string(reinterpret_cast<const char*>(file.pixels.data()), file.pixels.size()));
  for (const auto& [tag, more] : file.more) elements[tag] = more;
  std::string text = std::string(128, '\0') + "DICM" + element(2, 0, "UL", little(meta.size(), 4)) + meta;
  for (const auto& [tag, one] : elements) text += one;
  return text;
}

/// The same image, encoded by gdcmconv with `option`: by another library than the one that reads it.
inline void recompress(const std::string& from, const std::string& to, const std::string& option) {
  const std::string command = "gdcmconv " + option + " '" + from + "' '" + to + "' 2>/dev/null";
  if (std::system(command.c_str()) != 0)
    throw std::runtime_error(command + ": failed; the package libgdcm-tools has this program");
}

}  // namespace understudy::volume::testing
