// SPDX-License-Identifier: Apache-2.0
// Writes the header of an NRRD volume whose data is in a file of its own
// (teem.sourceforge.net/nrrd/format.html).
#pragma once

#include <array>
#include <string>

#include "volume/texel_type.h"

namespace understudy::volume {

/// Returns the header of texels that lie in `data`, a file in the same folder: x fastest, uncompressed,
/// little-endian. Colours are a first axis of four components. The spacing of texels is not written: a
/// texture has none.
std::string nrrd_header(const std::array<int, 3>& size, TexelType type, const std::string& data);

}  // namespace understudy::volume
