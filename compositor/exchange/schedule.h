// SPDX-License-Identifier: Apache-2.0
// Who sends what to whom, round by round. Every exchange is such a list; all ranks make the same one, from the
// footprints alone. exchange.h executes any list, and cost.h estimates its cost before anything is sent.
//
// Each rank holds one image. In a round it gives pieces of it away, keeps at most one piece itself, and blends
// all that it then has, front first. A rank's image always stands for neighbours in visibility order, so
// blending in the order of the senders' positions is right for operators that do not commute.
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
  volume::Rect rect;  ///< not empty; lies inside the sender's image
  bool written =
      false;  ///< written by the sender into the image buffer; only a head is sent; in the last round
  bool operator==(const Piece&) const = default;
};

struct Round {
  std::vector<Piece> pieces;             ///< also those that stay (from == to)
  std::vector<volume::Rect> afterwards;  ///< by rank: what its image covers after the round
};

struct Schedule {
  std::vector<Round> rounds;
  /// By rank: position of its image in visibility order; -1 for ranks with nothing to show.
  std::vector<int> position;
  bool clear_pixels_travel = false;  ///< also send pixels that no sample has reached, to measure their cost
  bool packed = false;               ///< send pixels packed, which takes time and saves bytes
  volume::Rect whole;  ///< the image that rank 0 ends with: the smallest rectangle that holds all footprints.
                       ///< If memory is given for it, any other rectangle that holds them will do
};

/// `order` holds all ranks, front first; `footprints` are by rank, empty if there is nothing to show. Ranks
/// without footprint take no part, except rank 0, which receives the image.
///
/// serial: all send to rank 0, cost (N - 1)(t + b). tree: neighbours in pairs, log2 N (t + b) (both Magallon,
/// Hopf, Ertl 2001, section 3). direct_send: one region per rank (Hsu 1993; Neumann 1994), assigned so that
/// most bytes are saved. binary_swap: halves with a partner, twice as far away each round (Ma 1994); if the
/// count is no power of two, some neighbours are folded together first. radix_k: direct-send in groups of
/// `factors`, one factor a round, whose product is the number of ranks that show something (Peterka 2009); by
/// default those of radix_factors().
Schedule schedule(Algorithm algorithm, std::span<const Rank> order, std::span<const volume::Rect> footprints,
                  std::span<const int> factors = {});

/// Marks pieces of the last round as written into the image buffer if their senders reach it (`reached_by`, by
/// rank; empty: none does) and no two pieces overlap: regions then go directly from each rank to the front end,
/// instead of being gathered by rank 0 (Mueller, Strengert, Ertl 2006 describe both ways).
void write_gathered(Schedule& schedule, const std::vector<bool>& reached_by);

/// Returns the prime factors of `count`, with pairs of twos made fours: a round of four has
/// three messages a rank where two rounds of two have two, but one wait instead of two, and no more bytes.
std::vector<int> radix_factors(int count);

}  // namespace understudy::compositor
