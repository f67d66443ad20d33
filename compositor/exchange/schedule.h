// SPDX-License-Identifier: Apache-2.0
// Who sends what to whom, round by round: every exchange is one of these lists, made by all ranks alike from
// the footprints alone. One executor (exchange.h) plays any of them, and what it will cost is counted from the
// list before anything is sent (cost.h).
//
// Each rank holds one image. In a round it gives pieces of it away, keeps at most one piece itself, and blends
// what it has then, front first. A rank's image always stands for neighbours in visibility order, so that
// blending by the senders' positions is right for operators that do not commute.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "compositor/exchange/communicator.h"
#include "volume/image.h"

namespace understudy::compositor {

enum class Algorithm : std::uint8_t { serial, tree, direct_send, binary_swap, radix_k };
constexpr std::size_t algorithm_count = 5;
std::string_view name_of(Algorithm algorithm);

struct Piece {
  Rank from = 0;
  Rank to = 0;
  volume::Rect rect;  ///< not empty; all inside the sender's image
  bool written =
      false;  ///< by the sender into the image's memory: only a control message travels; in the last round
  bool operator==(const Piece&) const = default;
};

struct Round {
  std::vector<Piece> pieces;             ///< also those that stay (from == to)
  std::vector<volume::Rect> afterwards;  ///< by rank: what its image covers after the round
};

struct Schedule {
  std::vector<Round> rounds;
  /// By rank: where its image stands in visibility order; -1 for ranks with nothing to show.
  std::vector<int> position;
  bool clear_pixels_travel = false;  ///< also those that no sample has reached, to see what they cost
  bool packed = false;               ///< pixels travel packed, which takes time and saves bytes
  volume::Rect whole;  ///< the image that rank 0 ends with: the smallest rectangle that holds all footprints.
                       ///< Where memory is given for it, any other that holds them will do
};

/// `order` holds all ranks, front first; `footprints` are by rank, empty where there is nothing to show. Ranks
/// without footprint take no part, but for rank 0, which receives the image.
///
/// serial: all send to rank 0, cost (N - 1)(t + b). tree: neighbours pairwise, log2 N (t + b) (both Magallon,
/// Hopf, Ertl 2001, section 3). direct_send: one region a rank (Hsu 1993; Neumann 1994), given to whom it saves
/// most bytes. binary_swap: halves with a partner, twice as far away each round (Ma 1994); neighbours of a
/// count that is no power of two are folded together first. radix_k: direct-send in groups of `factors`, one
/// factor a round, whose product is the number of ranks that show something (Peterka 2009); without factors
/// those of radix_factors().
Schedule schedule(Algorithm algorithm, std::span<const Rank> order, std::span<const volume::Rect> footprints,
                  std::span<const int> factors = {});

/// Marks the last round's pieces whose senders reach the image's memory (`reached_by`, by rank; empty: none
/// does) as written there, if all of them lie apart: regions then go directly to the front end from each rank,
/// instead of being gathered by rank 0 (Mueller, Strengert, Ertl 2006 have both ways).
void write_gathered(Schedule& schedule, const std::vector<bool>& reached_by);

/// Prime factors of `count`, pairs of twos made fours: rounds of four cost a quarter of the latency of two
/// rounds of two, and no more bytes.
std::vector<int> radix_factors(int count);

}  // namespace understudy::compositor
