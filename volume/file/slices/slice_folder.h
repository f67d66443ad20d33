// SPDX-License-Identifier: Apache-2.0
// Folders whose files are the slices of a volume.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "volume/file/readable_files.h"
#include "volume/file/slices/dicom_headers.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

/// The paths of the regular files in a folder, except hidden ones, in the order of the numbers in their names
/// (slice_9 before slice_10). Throws FileError.
std::vector<std::string> files_in_folder(const std::string& folder, const ReadableFiles& readable = {});

/// Opens the volume in a folder: a DICOM series, or TIFF files with one slice each, whose names differ in one
/// consecutive number. Other files are ignored. Throws FileError, also if there are both, or several series.
std::unique_ptr<VolumeFile> open_slice_folder(const std::string& folder, int time_step,
                                              const ReadableFiles& readable, DicomHeaders& headers);

/// Opens the DICOM series to which a file belongs, together with the files in its folder.
std::unique_ptr<VolumeFile> open_series_of_file(const std::string& file, int time_step,
                                                const ReadableFiles& readable, DicomHeaders& headers);

}  // namespace understudy::volume
