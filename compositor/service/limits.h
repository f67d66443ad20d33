// SPDX-License-Identifier: Apache-2.0
// Every bound of the render service: sizes that are checked before a message is trusted, and waiting times.
// Bounds of connections, whatever they carry: compositor/transport/limits.h.
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
constexpr std::size_t max_integrals = 4096;  ///< pixels of one request
constexpr double max_integral_ms = 2000;
constexpr std::uint64_t max_image_samples =
    std::uint64_t(1) << 41;  ///< of nodes shared by independent clients: 8192 x 8192 pixels of 32768 each
constexpr std::size_t max_table_entries = std::size_t(1) << 20;
constexpr int max_kept_pre_integration_tables = 4;  ///< of one application, on each node: 16 MiB each at most

// Messages.
static_assert(max_message_bytes == max_slice_bytes + (std::uint64_t(1) << 20),
              "a slice, and what is said of it");
constexpr std::uint64_t max_gl_server_message_bytes = std::uint64_t(1)
                                                      << 32;  ///< an application's call may carry a volume
constexpr std::uint64_t max_image_message_bytes =
    20 * max_window_pixels + (std::uint64_t(1) << 20);  ///< over TCP, with its pixels
constexpr std::uint64_t max_slice_range_bytes =
    std::uint64_t(1) << 23;  ///< several slices or boxes are sent together up to this size
constexpr std::size_t max_boxes_per_message = 4096;  ///< of texels
constexpr int max_ranks = 4096;
constexpr std::size_t max_clients = 64;  ///< waiting at the launcher, and served by a node group

// Times.
constexpr milliseconds alive_interval{1'000};      ///< between two messages of rank 0 that it is alive
constexpr milliseconds silence_patience{10'000};   ///< without such a message: rank 0 or its host has stopped
constexpr milliseconds unwanted_patience{10'000};  ///< for a request whose application has gone: the ranks hang
constexpr int max_unwanted_ms = 60'000;            ///< the most that rank 0 reports of that
constexpr milliseconds reply_patience{30'000};     ///< for a reply to any request but one for an image
constexpr milliseconds render_patience{20'000};    ///< for an image
constexpr milliseconds image_time{4'000};     ///< of nodes shared by independent clients: the longest image
constexpr milliseconds short_request{20};     ///< after shorter ones a client need not rest, unless refused
constexpr milliseconds active_within{2'000};  ///< clients with requests this recent have a share of the nodes
constexpr int rest_for_use = 2;               ///< a client may rest this many times what others have used
constexpr milliseconds longest_rest{10'000};  ///< below render_patience

}  // namespace understudy::compositor::limits
