// SPDX-License-Identifier: Apache-2.0
// The markers that a JPEG image begins with (ITU T.81, annex B).
#pragma once

#include <cstddef>
#include <span>

namespace understudy::volume {

/// Whether marker segments lead from its begin to that of a frame, each within `image`. DCMTK 3.6.7 looks for
/// that one in damaged images without end.
bool leads_to_a_jpeg_frame(std::span<const std::byte> image);

}  // namespace understudy::volume
