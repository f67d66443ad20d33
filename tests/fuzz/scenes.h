// SPDX-License-Identifier: Apache-2.0
// Initial streams in which the state changes that determines the meaning of pointer arguments: buffers, arrays,
// mappings, feedback.
#pragma once

#include <map>
#include <string>

#include "spu/stream/record.h"

namespace understudy::spu::testing {

/// Streams by name of their subject.
std::map<std::string, Records> scenes();

}  // namespace understudy::spu::testing
