// SPDX-License-Identifier: Apache-2.0
// DICOM files as part 10 of the standard has them, written without a library: explicit VR, little endian.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
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

/// What a test wants to be otherwise.
struct DicomFile {
  std::array<int, 2> size{13, 7};
  ScalarType type = ScalarType::i16;
  int stored_bits = 0;  ///< 0: all of them
  std::string series = "1.2.826.0.1.3680043.2.1125.1";
  int instance = 1;
  std::vector<double> position{0, 0, 0};
  std::vector<double> orientation{1, 0, 0, 0, 1, 0};
  double slope = 1;
  double intercept = 0;
  std::vector<std::vector<double>> frame_positions;  ///< of a file with several frames (Enhanced CT)
  unsigned samples = 1;
  std::string meaning = "MONOCHROME2";
  Bytes pixels;
};

inline std::string dicom_bytes(const DicomFile& file) {
  using namespace dicom;
  const bool enhanced = !file.frame_positions.empty();
  const std::string kind = enhanced ? "1.2.840.10008.5.1.4.1.1.2.1" : "1.2.840.10008.5.1.4.1.1.2";
  const std::string meta = element(2, 1, "OB", std::string("\0\1", 2)) + element(2, 2, "UI", kind) +
                           element(2, 3, "UI", file.series + "." + std::to_string(file.instance)) +
                           element(2, 0x10, "UI", "1.2.840.10008.1.2.1");
  const unsigned bits = unsigned(bytes_per_scalar(file.type)) * 8;
  const unsigned stored = file.stored_bits != 0 ? unsigned(file.stored_bits) : bits;
  const bool with_sign =
      file.type == ScalarType::i8 || file.type == ScalarType::i16 || file.type == ScalarType::i32;
  std::string text = std::string(128, '\0') + "DICM" + element(2, 0, "UL", little(meta.size(), 4)) + meta;
  text += element(8, 0x16, "UI", kind) +
          element(8, 0x18, "UI", file.series + "." + std::to_string(file.instance)) +
          element(8, 0x60, "CS", "CT") + element(8, 0x103E, "LO", "head") + element(0x18, 0x50, "DS", "5") +
          element(0x20, 0xE, "UI", file.series) + element(0x20, 0x11, "IS", "4") +
          element(0x20, 0x13, "IS", std::to_string(file.instance));
  if (!enhanced && !file.position.empty())
    text += element(0x20, 0x32, "DS", text_of(file.position)) +
            element(0x20, 0x37, "DS", text_of(file.orientation));
  text += number(0x28, 2, file.samples) + element(0x28, 4, "CS", file.meaning);
  if (file.samples > 1) text += number(0x28, 6, 0);
  if (enhanced) text += element(0x28, 8, "IS", std::to_string(file.frame_positions.size()));
  text += number(0x28, 0x10, unsigned(file.size[1])) + number(0x28, 0x11, unsigned(file.size[0]));
  if (!enhanced) text += element(0x28, 0x30, "DS", "0.5\\0.25");
  text += number(0x28, 0x100, bits) + number(0x28, 0x101, stored) + number(0x28, 0x102, stored - 1) +
          number(0x28, 0x103, with_sign ? 1 : 0);
  if (!enhanced)
    text += element(0x28, 0x1052, "DS", std::to_string(file.intercept)) +
            element(0x28, 0x1053, "DS", std::to_string(file.slope));
  if (enhanced) {
    const std::string measures = element(0x18, 0x50, "DS", "5") + element(0x28, 0x30, "DS", "0.5\\0.25");
    const std::string meaning = element(0x28, 0x1052, "DS", std::to_string(file.intercept)) +
                                element(0x28, 0x1053, "DS", std::to_string(file.slope)) +
                                element(0x28, 0x1054, "LO", "HU");
    text += sequence(0x5200, 0x9229,
                     {sequence(0x20, 0x9116, {element(0x20, 0x37, "DS", text_of(file.orientation))}) +
                      sequence(0x28, 0x9110, {measures}) + sequence(0x28, 0x9145, {meaning})});
    std::vector<std::string> frames;
    for (const std::vector<double>& position : file.frame_positions)
      frames.push_back(sequence(0x20, 0x9113, {element(0x20, 0x32, "DS", text_of(position))}));
    text += sequence(0x5200, 0x9230, frames);
  }
  return text + element(0x7FE0, 0x10, bits == 8 ? "OB" : "OW",
                        std::string(reinterpret_cast<const char*>(file.pixels.data()), file.pixels.size()));
}

/// The same image as gdcmconv encodes it with `option`, which is another library than the one that reads it.
inline void recompress(const std::string& from, const std::string& to, const std::string& option) {
  const std::string command = "gdcmconv " + option + " '" + from + "' '" + to + "' 2>/dev/null";
  if (std::system(command.c_str()) != 0)
    throw std::runtime_error(command + ": failed; the package libgdcm-tools has this program");
}

}  // namespace understudy::volume::testing
