// SPDX-License-Identifier: Apache-2.0
// How long an image takes on many ranks, from what it asks of each (frame_parts.h) and what that costs.
//
// Messages follow LogGP (Alexandrov, Ionescu, Schauser, Scheiman 1995): a rank is busy for `overhead` with each
// message that it sends or receives; messages leave it, and arrive, no closer to each other than `gap`, nor
// than the bytes of the one before take; each is on its way for `latency` and `per_byte` of its bytes. Packing,
// unpacking and blending keep a rank busy in between (as O does in LogGOPS: Hoefler, Schneider, Lumsdaine
// 2010).
#pragma once

#include <cstdint>

#include "apps/bench/frame_parts.h"
#include "compositor/exchange/counted_exchange.h"

namespace understudy::bench {

/// In seconds.
struct Costs {
  // The network's.
  double latency = 3e-6;      ///< L
  double overhead = 1e-6;     ///< o
  double gap = 1e-6;          ///< g
  double per_byte = 0.08e-9;  ///< G
  // Of one core, or of a whole machine where each rank has its own.
  double per_sample = 2e-9;
  double per_pixel_cast = 0;  ///< each pixel whose ray is set up
  double per_byte_packed = 0.2e-9;
  double per_byte_unpacked = 0.2e-9;
  double per_pixel_blended = 2e-9;
  double per_pixel_written = 2e-9;
  /// That all ranks share, as nodes on one machine do. None: each rank has a machine of its own.
  int cores = 0;
};

struct FrameTime {
  double render = 0;    ///< until the last rank has cast its box
  double exchange = 0;  ///< from there on, until rank 0 has the image
};

FrameTime time_of(const FrameParts& parts, const compositor::CountedExchange& exchange, const Costs& costs);

/// All samples on one rank, without an exchange.
double time_on_one_rank(const FrameParts& parts, const Costs& costs);

}  // namespace understudy::bench
