// SPDX-License-Identifier: Apache-2.0
// Describes in words what was recognised, for the report.
#pragma once

#include <string>

#include "spu/volume/pipeline/pipeline.h"
#include "spu/volume/request/image_request.h"
#include "spu/volume/texture/texels.h"

namespace understudy::spu {

/// Describes the volume of `texture`, drawn by `pipeline` and requested by `image`; `residual` is that of its
/// camera fit.
std::string explanation(const Pipeline& pipeline, const TextureDescription& texture, const ImageRequest& image,
                        double residual);

}  // namespace understudy::spu
