// SPDX-License-Identifier: Apache-2.0
// The ImageDescription of a TIFF stack, as written by ImageJ and OME.
#pragma once

#include <cstdint>
#include <string>

#include "volume/texture_space.h"

namespace understudy::volume {

struct TiffDescription {
  bool by_imagej = false;
  std::int64_t slices = 0;  ///< 0: not specified, each page is a slice
  std::int64_t time_steps = 1;
  std::int64_t channels = 1;
  /// Pages from one slice, time step or channel to the next.
  std::int64_t slice_stride = 1;
  std::int64_t step_stride = 0;
  std::int64_t channel_stride = 0;
  Vec3 spacing{1, 1, 1};  ///< all in the same unit

  std::int64_t images() const { return slices * time_steps * channels; }
};

/// Throws FileError.
[[noreturn]] void fail_tiff(const std::string& path, const std::string& what);

/// `path` is for messages. Throws FileError if the description is inconsistent.
TiffDescription tiff_description(const std::string& text, const std::string& path);

}  // namespace understudy::volume
