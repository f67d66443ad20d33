// SPDX-License-Identifier: Apache-2.0
// The spatial order of the images of a DICOM series.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volume/file/slices/dicom_image.h"

namespace understudy::volume {

/// One frame of a file.
struct DicomImage {
  std::shared_ptr<const DicomHeader> file;
  int frame = 0;

  const DicomFrame& header() const { return file->frames[std::size_t(frame)]; }
  const std::optional<DicomPlane>& plane() const { return header().plane; }
};

/// The images at one place, in temporal order.
struct DicomPlace {
  double along = 0;  ///< in mm, along the normal of the slices
  std::vector<DicomImage> images;
};

using DicomFiles = std::vector<std::shared_ptr<const DicomHeader>>;

/// The places of one series' files, from first to last, with equally many images at each. Without planes, each
/// image has a place of its own, by the number of its file. Throws FileError if they do not form a box of
/// slices: different sizes, directions or distances, missing or duplicate images, and slices with shifted rows,
/// as from a tilted gantry.
std::vector<DicomPlace> places_of(DicomFiles files);

/// The distance between two places, in mm.
double distance_of(const std::vector<DicomPlace>& places);

}  // namespace understudy::volume
