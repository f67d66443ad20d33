// SPDX-License-Identifier: Apache-2.0
// What a render service answers to a request.
#pragma once

#include "volume/frame_counts.h"
#include "volume/image.h"

namespace understudy::compositor {

struct Rendered {
  volume::ImageView image;  ///< over its footprint only; valid until the service's next call but integrals()
  volume::FrameCounts counts;
  bool repeated = false;  ///< nothing was cast: it is an image that was there already
};

}  // namespace understudy::compositor
