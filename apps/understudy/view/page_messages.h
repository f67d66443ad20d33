// SPDX-License-Identifier: Apache-2.0
// What is said to a viewer's page: JSON text, and images with a head of JSON (README.md lists the keys).
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

/// How far the nodes are; `text` says it to people.
std::string status_message(Readiness readiness, std::string_view text, double part_done);

/// What is there to be seen, and how it is seen at first.
std::string volume_message(const ShownVolume& volume, const ViewState& state);

/// What the image `sequence` and the ranks say of themselves.
std::string figures_message(std::uint64_t sequence, const FileScene& scene,
                            const std::optional<ShownVolume::Exactness>& exactness,
                            const std::vector<compositor::RankLoad>& ranks);

/// What was asked for cannot be drawn.
std::string refusal_message(std::uint64_t sequence, std::string_view reason);

/// The head's length (four bytes, the lowest first), the head, and the image: PNG, or JPEG.
std::vector<std::byte> image_message(const FileScene& scene, const ViewState& state,
                                     const ShownVolume::Drawn& drawn);

}  // namespace understudy::launcher
