// SPDX-License-Identifier: Apache-2.0
// Streams to begin with, in which what makes a pointer of an argument changes: buffers, arrays, mappings,
// feedback.
#pragma once

#include <map>
#include <string>

#include "spu/stream/record.h"

namespace understudy::spu::testing {

/// By what they are about.
std::map<std::string, Records> scenes();

}  // namespace understudy::spu::testing
