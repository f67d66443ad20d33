// SPDX-License-Identifier: Apache-2.0
// Models the time of an image on many ranks, from the work of each rank (frame_parts.h) and its costs.
//
// Messages follow LogGP (Alexandrov, Ionescu, Schauser, Scheiman 1995): sending or receiving a message
// occupies a rank for `overhead`; consecutive messages leave or arrive at least `gap` apart, and no faster
// than the bytes of the previous one allow; a message is in transit for `latency` plus `per_byte` for each of
// its bytes. Packing, unpacking and blending occupy the rank in between (as O does in LogGOPS: Hoefler,
// Schneider, Lumsdaine 2010).
#pragma once

#include <cstdint>

#include "apps/bench/frame_parts.h"
#include "compositor/exchange/counted_exchange.h"

namespace understudy::bench {

/// All costs are in seconds.
struct Costs {
  // Of the network.
  double latency = 3e-6;      ///< L
  double overhead = 1e-6;     ///< o
  double gap = 1e-6;          ///< g
  double per_byte = 0.08e-9;  ///< G
  // Of one core, or of a whole machine if each rank has its own.
  double per_sample = 2e-9;
  double per_pixel_cast = 0;  ///< for each pixel whose ray is set up
  double per_byte_packed = 0.2e-9;
  double per_byte_unpacked = 0.2e-9;
  double per_pixel_blended = 2e-9;
  double per_pixel_written = 2e-9;
  /// Cores that all ranks share, as nodes on one machine do. 0: each rank has a machine of its own.
  int cores = 0;
};

struct FrameTime {
  double render = 0;    ///< time until the last rank has cast its box
  double exchange = 0;  ///< time from then until rank 0 has the image
};

FrameTime time_of(const FrameParts& parts, const compositor::CountedExchange& exchange, const Costs& costs);

/// Returns the time for all samples on one rank, without an exchange.
double time_on_one_rank(const FrameParts& parts, const Costs& costs);

}  // namespace understudy::bench
