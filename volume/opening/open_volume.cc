// SPDX-License-Identifier: Apache-2.0
#include "volume/opening/open_volume.h"

#include <fmt/format.h>

#include "volume/file/chunks/zarr.h"
#include "volume/file/chunks/zarr_image.h"
#include "volume/file/file_error.h"
#include "volume/file/hierarchical_volume.h"
#include "volume/file/meta_image.h"
#include "volume/file/nifti.h"
#include "volume/file/nrrd.h"
#include "volume/file/raw.h"
#include "volume/file/slices/dicom_headers.h"
#include "volume/file/slices/dicom_image.h"
#include "volume/file/slices/slice_folder.h"
#include "volume/file/slices/tiff_image.h"
#include "volume/file/slices/tiff_stack.h"
#include "volume/file/synthetic.h"
#include "volume/file/vti.h"

namespace understudy::volume {

namespace {

std::unique_ptr<VolumeFile> opened(const std::string& name, const FileHints& hints, const ReadableFiles& files,
                                   DicomHeaders& headers) {
  const bool folder = !is_synthetic(name) && files.is_folder(name);
  const bool in_levels = !is_synthetic(name) && !folder && is_hierarchical(name, files);
  if (in_levels) return open_level(name, hints.level, files);
  if (folder && is_zarr(name, files)) return open_zarr(name, hints, files);
  if (hints.level != 0)
    throw FileError(
        fmt::format("{}: has no levels of detail; make some: understudy convert {} -o NAME.uvol", name, name));
  if (is_synthetic(name)) return open_synthetic(name);
  if (folder) return open_slice_folder(name, hints.time_step, files, headers);
  if (is_nifti(name)) return open_nifti(name, hints.time_step, files);
  if (is_meta_image(name)) return open_meta_image(name, hints.time_step, files);
  if (is_vti(name)) return open_vti(name, files);
  if (is_nrrd(name, files)) return open_nrrd(name, hints.time_step, files);
  // A file may be valid DICOM and TIFF at once, beginning like a TIFF file.
  if (is_dicom(name, files)) return open_series_of_file(name, hints.time_step, files, headers);
  if (is_tiff(name, files)) return open_tiff(name, hints, files);
  return open_raw(name, hints, files);
}

}  // namespace

std::unique_ptr<VolumeFile> open_volume(const std::string& name, const FileHints& hints,
                                        const ReadableFiles& files) {
  DicomHeaders headers;
  return open_volume(name, hints, files, headers);
}

std::unique_ptr<VolumeFile> open_volume(const std::string& name, const FileHints& hints,
                                        const ReadableFiles& files, DicomHeaders& headers) {
  std::unique_ptr<VolumeFile> file = opened(name, hints, files, headers);
  check_time_step(hints.time_step, file->description().time_steps, name);
  checked_channel(hints.channel, file->description().channels, name);
  return file;
}

}  // namespace understudy::volume
