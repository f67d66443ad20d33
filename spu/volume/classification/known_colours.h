// SPDX-License-Identifier: Apache-2.0
// What is remembered of the colours of one volume.
#pragma once

#include <optional>
#include <vector>

#include "spu/volume/classification/probe.h"
#include "spu/volume/classification/sample_rounding.h"

namespace understudy::spu {

struct KnownColours {
  std::optional<Probed> probed;
  std::vector<float> probed_under;  ///< state that decides what probing finds
  SampleRounding rounding;          ///< of slices and of ray casters
};

}  // namespace understudy::spu
