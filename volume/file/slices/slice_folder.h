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

/// The paths of the regular files in a folder, hidden ones aside, in the order of the numbers in their names
/// (slice_9 before slice_10). Throws FileError.
std::vector<std::string> files_in_folder(const std::string& folder, const ReadableFiles& readable = {});

/// The volume that a folder holds: a DICOM series, or TIFF files with one slice each, in whose names one number
/// counts on. What is neither is passed over. Throws FileError, also where there are both, or several series.
std::unique_ptr<VolumeFile> open_slice_folder(const std::string& folder, int time_step,
                                              const ReadableFiles& readable, DicomHeaders& headers);

/// The DICOM series that a file belongs to, with the files beside it.
std::unique_ptr<VolumeFile> open_series_of_file(const std::string& file, int time_step,
                                                const ReadableFiles& readable, DicomHeaders& headers);

}  // namespace understudy::volume
