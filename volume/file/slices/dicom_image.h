// SPDX-License-Identifier: Apache-2.0
// One DICOM file: its header and its pixels. DCMTK reads uncompressed, RLE, JPEG (lossless, baseline, extended)
// and JPEG-LS data, OpenJPEG reads JPEG 2000. dicom.nema.org/medical/dicom/current: parts 3 (modules) and 5
// (encodings).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volume/file/readable_files.h"
#include "volume/file/scalar_type.h"
#include "volume/matrix.h"

namespace understudy::volume {

/// An image's position in the patient, in mm (Image Plane Module, Plane Position and Plane Orientation macros).
struct DicomPlane {
  Vec3 position;  ///< of the first pixel's centre
  /// Unit vectors: along a row, along a column, and their cross product.
  Vec3 rows;
  Vec3 columns;
  Vec3 normal;
};

struct DicomFrame {
  std::optional<DicomPlane> plane;
  double time = 0;  ///< Temporal Position Index: orders the frames at one place
  /// A scalar s has the value slope * s + intercept (Modality LUT Module, Pixel Value Transformation macro, and
  /// the Dose Grid Scaling of radiotherapy).
  double slope = 1;
  double intercept = 0;
};

struct DicomHeader {
  std::string path;
  std::string series;       ///< Series Instance UID
  std::string description;  ///< for display
  std::string image;        ///< SOP Instance UID
  /// Sort key in time: Temporal Position Identifier, Acquisition Number, Trigger Time, Echo Number and Instance
  /// Number, 0 where missing.
  std::array<double, 5> order{};
  bool frames_are_times = false;  ///< Frame Increment Pointer: frames follow each other in time
  std::array<int, 2> size{};
  ScalarType type = ScalarType::u8;
  Vec3 spacing{1, 1, 1};  ///< in mm; the third one is used if frames have no planes
  std::vector<DicomFrame> frames;
  std::uint64_t file_bytes = 0;
  std::string trouble;  ///< why its pixels cannot be read; empty: they can
};

/// Throws FileError.
[[noreturn]] void fail_dicom(const std::string& path, const std::string& what);

/// By the prefix after the preamble, or, if both are missing, by the name (.dcm) and the first element. Throws
/// FileError if the file cannot be read.
bool is_dicom(const std::string& path, const ReadableFiles& files);

/// Empty if the file contains no image, like reports and directories. Throws FileError for damaged files.
std::optional<DicomHeader> dicom_header(const std::string& path, const ReadableFiles& files);

/// Reads frames of a file, which stays open for further ones.
class DicomFrames {
 public:
  /// Throws FileError.
  DicomFrames(const DicomHeader& header, const ReadableFiles& files);
  ~DicomFrames();

  const std::string& path() const;
  /// Fills `scalars`. Throws FileError.
  void read(int frame, std::span<std::byte> scalars);

 private:
  class Decoder;
  std::unique_ptr<Decoder> decoder_;
};

}  // namespace understudy::volume
