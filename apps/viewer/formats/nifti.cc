// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/formats/nifti.h"

#include <fmt/format.h>
#include <nifti1_io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "apps/viewer/formats/bytes.h"
#include "apps/viewer/formats/widen.h"
#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

struct FreeImage {
  void operator()(nifti_image* image) const { nifti_image_free(image); }
};

template <typename T>
void scale_or_keep(Volume& volume, ScalarType kept, double slope, double intercept) {
  if (slope == 1 && intercept == 0) {
    volume.type = kept;
    return;
  }
  volume.voxels = as_float32<T>(volume.voxels, slope, intercept);
  volume.type = ScalarType::f32;
}

template <typename T>
void widen(Volume& volume, double slope, double intercept) {
  volume.voxels = as_float32<T>(volume.voxels, slope, intercept);
  volume.type = ScalarType::f32;
}

/// Keeps the voxels' type if the viewer supports it and the file does not scale them;
/// otherwise converts them to f32.
void give_type(Volume& volume, const nifti_image& image, double slope, double intercept,
               const std::string& path) {
  switch (image.datatype) {
    case NIFTI_TYPE_UINT8:
      scale_or_keep<std::uint8_t>(volume, ScalarType::u8, slope, intercept);
      break;
    case NIFTI_TYPE_INT8:
      scale_or_keep<std::int8_t>(volume, ScalarType::i8, slope, intercept);
      break;
    case NIFTI_TYPE_UINT16:
      scale_or_keep<std::uint16_t>(volume, ScalarType::u16, slope, intercept);
      break;
    case NIFTI_TYPE_INT16:
      scale_or_keep<std::int16_t>(volume, ScalarType::i16, slope, intercept);
      break;
    case NIFTI_TYPE_FLOAT32:
      scale_or_keep<float>(volume, ScalarType::f32, slope, intercept);
      break;
    case NIFTI_TYPE_INT32:
      widen<std::int32_t>(volume, slope, intercept);
      break;
    case NIFTI_TYPE_UINT32:
      widen<std::uint32_t>(volume, slope, intercept);
      break;
    case NIFTI_TYPE_INT64:
      widen<std::int64_t>(volume, slope, intercept);
      break;
    case NIFTI_TYPE_UINT64:
      widen<std::uint64_t>(volume, slope, intercept);
      break;
    case NIFTI_TYPE_FLOAT64:
      widen<double>(volume, slope, intercept);
      break;
    default:
      throw Error(ExitCode::bad_file,
                  fmt::format("{}: voxels of type {} are not scalars; extract one component first", path,
                              nifti_datatype_string(image.datatype)));
  }
}

}  // namespace

bool is_nifti(const std::string& path) {
  constexpr std::array<std::string_view, 6> extensions = {".nii",    ".nii.gz", ".hdr",
                                                          ".hdr.gz", ".img",    ".img.gz"};
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](std::string_view extension) { return has_extension(path, extension); });
}

Volume load_nifti(const std::string& path) {
  nifti_set_debug_level(0);  // suppresses its own messages
  const std::unique_ptr<nifti_image, FreeImage> image(nifti_image_read(path.c_str(), 0));
  if (!image || !image->iname)
    throw Error(
        ExitCode::bad_file,
        fmt::format(
            "{}: not a readable NIfTI-1 file (header missing, truncated or damaged); get the file again, "
            "or give raw voxels another name and --size X Y Z",
            path));
  Volume volume;
  volume.size = {image->nx, std::max(image->ny, 1), std::max(image->nz, 1)};
  volume.spacing = {image->dx, image->dy, image->dz};
  for (double& distance : volume.spacing)
    if (distance == 0 || !std::isfinite(distance)) distance = 1;  // unused dimensions carry no distance

  volume_bytes(volume.size, ScalarType::f32, path);
  const std::int64_t bytes = volume.size[0] * volume.size[1] * volume.size[2] * image->nbyper;
  const std::int64_t offset = std::max<std::int64_t>(image->iname_offset, 0);
  // niftiio's own reader silently replaces NaN by 0; this one keeps NaN voxels, so that they are counted.
  volume.voxels = read_bytes(image->iname, offset, bytes, Remainder::allowed,
                             fmt::format("the header of {} requires {} voxels of {} bytes; get the file again",
                                         path, text_of(volume.size), image->nbyper));
  if (image->byteorder != nifti_short_order())
    swap_byte_order(volume.voxels, static_cast<std::size_t>(std::max(image->swapsize, 1)));

  const bool scaled =
      image->scl_slope != 0 && std::isfinite(image->scl_slope) && std::isfinite(image->scl_inter);
  const double slope = scaled ? image->scl_slope : 1.0;
  const double intercept = scaled ? image->scl_inter : 0.0;
  give_type(volume, *image, slope, intercept, path);
  return volume;
}

}  // namespace viewer
