// SPDX-License-Identifier: Apache-2.0
// Messages to a page: JSON text, and images with a JSON header (README.md lists the keys).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/understudy/view/shown_volume.h"
#include "apps/understudy/view/view_state.h"

namespace understudy::launcher {

enum class Readiness { loading, lost, ready };

/// State of the nodes; `text` describes it to the user.
std::string status_message(Readiness readiness, std::string_view text, double part_done);

/// The volume, and the initial settings of the view.
std::string volume_message(const ShownVolume& volume, const ViewState& state);

/// Figures of the image `sequence` and of the ranks.
std::string figures_message(std::uint64_t sequence, const FileScene& scene,
                            const std::optional<ShownVolume::Exactness>& exactness,
                            const std::vector<compositor::RankLoad>& ranks);

/// The requested image cannot be rendered.
std::string refusal_message(std::uint64_t sequence, std::string_view reason);

/// The length of the header (four bytes, little endian), the header, and the image as PNG or JPEG.
std::vector<std::byte> image_message(const FileScene& scene, const ViewState& state,
                                     const ShownVolume::Drawn& drawn);

}  // namespace understudy::launcher
