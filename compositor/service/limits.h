// SPDX-License-Identifier: Apache-2.0
// Every bound of the render service: what a message may promise before it is believed, and how long anybody
// waits. Those of connections, whatever they carry: compositor/transport/limits.h.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "compositor/transport/limits.h"

namespace understudy::compositor::limits {

// Volumes. The longest axis is volume::max_axis_texels, the most slice planes volume::max_planes.
constexpr std::uint64_t max_slice_bytes = std::uint64_t(1) << 28;   ///< one z-slice: 8192 x 8192 x RGBA
constexpr std::uint64_t max_volume_bytes = std::uint64_t(1) << 38;  ///< stored texels
constexpr std::size_t max_volumes_per_client = 256;

// Requests and images.
constexpr int max_viewport_extent = 1 << 16;                         ///< pixels along one side
constexpr int max_viewport_offset = 1 << 20;                         ///< of a viewport's corner from the origin
constexpr std::uint64_t max_window_pixels = std::uint64_t(1) << 26;  ///< 8192 x 8192
constexpr std::size_t max_clip_planes = 64;
constexpr int max_ray_offsets = 1 << 20;
constexpr std::size_t max_integrals = 4096;  ///< pixels of one question
constexpr double max_integral_ms = 2000;
constexpr std::uint64_t max_image_samples =
    std::uint64_t(1) << 41;  ///< of nodes that independent clients share: 8192 x 8192 pixels of 32768 each
constexpr std::size_t max_table_entries = std::size_t(1) << 20;
constexpr int max_kept_pre_integration_tables = 4;  ///< of one application, on each node: 16 MiB each at most

// Messages.
static_assert(max_message_bytes == max_slice_bytes + (std::uint64_t(1) << 20),
              "a slice, and what is said of it");
constexpr std::uint64_t max_gl_server_message_bytes = std::uint64_t(1)
                                                      << 32;  ///< one call of an application may bring a volume
constexpr std::uint64_t max_image_message_bytes =
    20 * max_window_pixels + (std::uint64_t(1) << 20);  ///< over TCP, with its pixels
constexpr std::uint64_t max_slice_range_bytes =
    std::uint64_t(1) << 23;  ///< several slices or boxes travel together up to this size
constexpr std::size_t max_boxes_per_message = 4096;  ///< of texels
constexpr int max_ranks = 4096;
constexpr std::size_t max_clients = 64;  ///< waiting at the launcher, and served by a node group

// Patience.
constexpr milliseconds alive_interval{1'000};      ///< between two words of rank 0 that it lives
constexpr milliseconds silence_patience{10'000};   ///< without such a word: rank 0 is stopped, or its machine
constexpr milliseconds unwanted_patience{10'000};  ///< at a request whose application has gone: the ranks hang
constexpr int max_unwanted_ms = 60'000;            ///< what rank 0 tells of that at most
constexpr milliseconds reply_patience{30'000};     ///< an answer to anything but a request for an image
constexpr milliseconds render_patience{20'000};    ///< an image
constexpr milliseconds image_time{4'000};     ///< of nodes that independent clients share: the longest image
constexpr milliseconds short_request{20};     ///< after which a client need not rest, unless it was refused
constexpr milliseconds active_within{2'000};  ///< others whose requests are so recent have a share of the nodes
constexpr int rest_for_use = 2;               ///< times what others have used a client may rest for them
constexpr milliseconds longest_rest{10'000};  ///< below render_patience

}  // namespace understudy::compositor::limits
