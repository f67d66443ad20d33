// SPDX-License-Identifier: Apache-2.0
// Work done and work skipped while rendering one frame, as counted by the nodes.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// Work done for one frame, and the work that was skipped. Sums over nodes.
struct FrameCounts {
  std::uint64_t rays = 0;  ///< rays that intersect the region
  std::uint64_t rays_terminated = 0;
  std::uint64_t samples = 0;  ///< samples inside the region, including skipped ones
  std::uint64_t samples_taken = 0;
  std::uint64_t samples_hidden = 0;  ///< skipped because opaque samples hide them
  std::uint64_t dominated_samples =
      0;                     ///< skipped under a maximum: in empty bricks, or blocks without larger samples
  std::uint64_t blocks = 0;  ///< blocks of 8^3 cells held
  std::uint64_t blocks_empty = 0;  ///< of these, blocks that are invisible under the classification
  std::uint64_t nodes_idle = 0;    ///< nodes that had nothing to show and sent nothing
  // Compositing traffic between nodes: actual, and what it would be without footprints.
  std::uint64_t bytes_exchanged = 0;
  std::uint64_t bytes_of_whole_windows = 0;
  std::uint64_t messages = 0;
  std::uint64_t messages_of_whole_windows = 0;
  double division_ms = 0;   ///< slowest node: time to divide the image (sort-first)
  double render_ms = 0;     ///< slowest node: time to render
  double processor_ms = 0;  ///< of all threads that estimated costs and cast rays
  double composite_ms = 0;

  /// Adds the counts of another volume of the same frame. Volumes are rendered in turn, so times add up too.
  FrameCounts& operator+=(const FrameCounts& other) {
    rays += other.rays;
    rays_terminated += other.rays_terminated;
    samples += other.samples;
    samples_taken += other.samples_taken;
    samples_hidden += other.samples_hidden;
    dominated_samples += other.dominated_samples;
    blocks += other.blocks;
    blocks_empty += other.blocks_empty;
    nodes_idle += other.nodes_idle;
    bytes_exchanged += other.bytes_exchanged;
    bytes_of_whole_windows += other.bytes_of_whole_windows;
    messages += other.messages;
    messages_of_whole_windows += other.messages_of_whole_windows;
    division_ms += other.division_ms;
    render_ms += other.render_ms;
    processor_ms += other.processor_ms;
    composite_ms += other.composite_ms;
    return *this;
  }
};

}  // namespace understudy::volume
