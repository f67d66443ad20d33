// SPDX-License-Identifier: Apache-2.0
// Where the images of a DICOM series lie, one behind the other.
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

/// Images that lie at one place, in the order of time.
struct DicomPlace {
  double along = 0;  ///< in mm, in the direction of the slices' normal
  std::vector<DicomImage> images;
};

using DicomFiles = std::vector<std::shared_ptr<const DicomHeader>>;

/// Of the files of one series, from first to last, as many images at each place; without planes each image has
/// a place of its own, by the number of its file. Throws FileError where they make no box of slices: other
/// sizes, directions or distances, images that are missing or double, and rows of slices that are shifted, as
/// those of a tilted gantry are.
std::vector<DicomPlace> places_of(DicomFiles files);

/// Between two places, in mm.
double distance_of(const std::vector<DicomPlace>& places);

}  // namespace understudy::volume
