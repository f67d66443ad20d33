// SPDX-License-Identifier: Apache-2.0
// What rendering one frame took, and what was skipped, as counted by the nodes.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// What one frame did and, beside it, what it left out. Sums over nodes.
struct FrameCounts {
  std::uint64_t rays = 0;  ///< rays that meet the region
  std::uint64_t rays_terminated = 0;
  std::uint64_t samples = 0;  ///< samples inside the region, had nothing been left out
  std::uint64_t samples_taken = 0;
  std::uint64_t samples_hidden = 0;  ///< left out behind what is opaque
  std::uint64_t dominated_samples =
      0;                     ///< left out under a maximum, in empty bricks or such that show nothing larger
  std::uint64_t blocks = 0;  ///< blocks of 8^3 cells held
  std::uint64_t blocks_empty = 0;  ///< of these, invisible under the classification
  std::uint64_t nodes_idle = 0;    ///< nodes that had nothing to show and sent nothing
  // Between nodes, for compositing: what travelled, and what would have without footprints.
  std::uint64_t bytes_exchanged = 0;
  std::uint64_t bytes_of_whole_windows = 0;
  std::uint64_t messages = 0;
  std::uint64_t messages_of_whole_windows = 0;
  double division_ms = 0;   ///< slowest node: time to divide the image (sort-first)
  double render_ms = 0;     ///< likewise
  double processor_ms = 0;  ///< of all threads that estimated costs and cast rays
  double composite_ms = 0;

  /// Adds another volume of the same frame: they are rendered one after the other, so times add up too.
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
