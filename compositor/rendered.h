// SPDX-License-Identifier: Apache-2.0
// What a render service returns for a request.
#pragma once

#include "volume/frame_counts.h"
#include "volume/image.h"

namespace understudy::compositor {

struct Rendered {
  volume::ImageView image;  ///< over its footprint only; valid until the service's next call but integrals()
  volume::FrameCounts counts;
  bool repeated = false;  ///< no rays were cast: the image existed already
  bool lossy = false;     ///< sent as JPEG, because its view moved; RenderRequest::exact prevents it
};

}  // namespace understudy::compositor
