// SPDX-License-Identifier: Apache-2.0
// What was recognised, in plain words, for the report.
#pragma once

#include <string>

#include "spu/volume/pipeline/pipeline.h"
#include "spu/volume/request/image_request.h"
#include "spu/volume/texture/texels.h"

namespace understudy::spu {

/// The volume of `texture` as `pipeline` draws it and `image` asks for it; its camera fits to `residual`.
std::string explanation(const Pipeline& pipeline, const TextureDescription& texture, const ImageRequest& image,
                        double residual);

}  // namespace understudy::spu
