// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/schedule.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <stdexcept>
#include <tuple>

namespace understudy::compositor {

namespace {

using volume::Rect;

/// Returns the k-th of `count` regions of `whole`, cut across its longer side; none is empty unless it must be.
Rect region_of(const Rect& whole, std::size_t k, std::size_t count) {
  const auto cut = [&](int length, std::size_t at) {
    return int(std::uint64_t(length) * std::uint64_t(at) / std::uint64_t(count));
  };
  Rect result = whole;
  if (whole.height >= whole.width) {
    result.y += cut(whole.height, k);
    result.height = cut(whole.height, k + 1) - cut(whole.height, k);
  } else {
    result.x += cut(whole.width, k);
    result.width = cut(whole.width, k + 1) - cut(whole.width, k);
  }
  return result;
}

/// A schedule under construction: what every rank holds now.
class Rounds {
 public:
  Rounds(std::span<const Rank> order, std::span<const Rect> footprints)
      : held_(footprints.begin(), footprints.end()) {
    result_.position.assign(footprints.size(), -1);
    for (const Rank rank : order) {
      if (footprints[std::size_t(rank)].empty()) continue;
      result_.position[std::size_t(rank)] = int(shown_.size());
      shown_.push_back(rank);
      result_.whole = bounding(result_.whole, footprints[std::size_t(rank)]);
    }
  }

  /// The ranks that show something, front first.
  const std::vector<Rank>& shown() const { return shown_; }
  const Rect& whole() const { return result_.whole; }
  const Rect& held(Rank rank) const { return held_[std::size_t(rank)]; }

  void begin() {
    round_ = {};
    round_.afterwards.assign(held_.size(), {});
  }
  /// Gives the part of `from`'s image that lies in `region` to `to`; what is given to no rank is dropped.
  void give(Rank from, Rank to, const Rect& region) {
    const Rect rect = intersection(held(from), region);
    if (rect.empty()) return;
    round_.pieces.push_back({from, to, rect, false});
    Rect& after = round_.afterwards[std::size_t(to)];
    after = bounding(after, rect);
  }
  void keep(Rank rank) { give(rank, rank, held(rank)); }
  void end() {
    held_ = round_.afterwards;
    if (std::ranges::any_of(round_.pieces, [](const Piece& piece) { return piece.from != piece.to; }))
      result_.rounds.push_back(std::move(round_));
  }

  Schedule finish() {
    begin();
    for (std::size_t rank = 0; rank < held_.size(); ++rank) give(Rank(rank), 0, held_[rank]);
    end();
    return std::move(result_);
  }

 private:
  std::vector<Rect> held_;
  std::vector<Rank> shown_;
  Round round_;
  Schedule result_;
};

void pair_up(Rounds& rounds) {
  std::vector<Rank> left = rounds.shown();
  while (left.size() > 1) {
    rounds.begin();
    std::vector<Rank> winners;
    for (std::size_t i = 0; i < left.size(); i += 2) {
      // The image must end on rank 0, so rank 0 wins its pair.
      const bool second_wins = i + 1 < left.size() && left[i + 1] == 0;
      winners.push_back(left[second_wins ? i + 1 : i]);
      rounds.keep(winners.back());
      if (i + 1 < left.size()) {
        const Rank loser = left[second_wins ? i : i + 1];
        rounds.give(loser, winners.back(), rounds.held(loser));
      }
    }
    rounds.end();
    left = std::move(winners);
  }
}

/// Assigns regions to ranks so that a rank already holds much of its region: the largest overlap first.
std::vector<Rank> owners_of_tiles(const Rounds& rounds) {
  const std::vector<Rank>& shown = rounds.shown();
  const std::size_t count = shown.size();
  std::vector<std::tuple<std::size_t, std::size_t, std::size_t>> overlaps;  // pixels, rank's index, region
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < count; ++k)
      if (const std::size_t pixels =
              intersection(rounds.held(shown[i]), region_of(rounds.whole(), k, count)).pixels();
          pixels > 0)
        overlaps.emplace_back(pixels, i, k);
  std::ranges::stable_sort(overlaps, std::greater<>{}, [](const auto& entry) { return std::get<0>(entry); });
  std::vector<Rank> owners(count, -1);
  std::vector<bool> served(count, false);
  for (const auto& [pixels, i, k] : overlaps) {
    if (owners[k] >= 0 || served[i]) continue;
    owners[k] = shown[i];
    served[i] = true;
  }
  std::size_t next = 0;
  for (Rank& owner : owners) {
    if (owner >= 0) continue;
    while (served[next]) ++next;
    owner = shown[next];
    served[next] = true;
  }
  return owners;
}

void send_directly(Rounds& rounds) {
  const std::size_t count = rounds.shown().size();
  if (count < 2) return;
  const std::vector<Rank> owners = owners_of_tiles(rounds);
  rounds.begin();
  for (const Rank from : rounds.shown())
    for (std::size_t k = 0; k < count; ++k) rounds.give(from, owners[k], region_of(rounds.whole(), k, count));
  rounds.end();
}

/// `ranks`, front first, exchange in groups, whose size in each round is one of `factors`. The members of a
/// group are neighbours in the first round, then as far apart as the groups before were large. The region that
/// the members share is cut into one region for each of them.
void exchange_in_groups(Rounds& rounds, std::span<const Rank> ranks, std::span<const int> factors) {
  std::vector<Rect> regions(ranks.size(), rounds.whole());
  std::size_t stride = 1;
  for (const int factor : factors) {
    const auto members = std::size_t(factor);
    rounds.begin();
    std::vector<Rect> cut(ranks.size());
    for (std::size_t p = 0; p < ranks.size(); ++p) {
      const std::size_t mine = p / stride % members;
      const std::size_t first = p - mine * stride;
      for (std::size_t j = 0; j < members; ++j)
        rounds.give(ranks[p], ranks[first + j * stride], region_of(regions[p], j, members));
      cut[p] = region_of(regions[p], mine, members);
    }
    rounds.end();
    regions = std::move(cut);
    stride *= members;
  }
}

void swap_halves(Rounds& rounds) {
  const std::vector<Rank>& shown = rounds.shown();
  const std::size_t power = std::bit_floor(shown.size());
  const std::size_t folded = shown.size() - power;
  std::vector<Rank> left;
  rounds.begin();
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const bool gives = i < 2 * folded && i % 2 == 1;
    rounds.give(shown[i], gives ? shown[i - 1] : shown[i], rounds.held(shown[i]));
    if (!gives) left.push_back(shown[i]);
  }
  rounds.end();
  exchange_in_groups(rounds, left, std::vector<int>(std::size_t(std::bit_width(power) - 1), 2));
}

}  // namespace

std::string_view name_of(Algorithm algorithm) {
  switch (algorithm) {
    case Algorithm::serial:
      return "serial";
    case Algorithm::tree:
      return "tree";
    case Algorithm::direct_send:
      return "direct-send";
    case Algorithm::binary_swap:
      return "binary-swap";
    case Algorithm::radix_k:
      return "radix-k";
  }
  return "";
}

std::vector<int> radix_factors(int count) {
  std::vector<int> factors;
  for (; count % 4 == 0; count /= 4) factors.push_back(4);
  for (int prime = 2; count > 1; ++prime)
    for (; count % prime == 0; count /= prime) factors.push_back(prime);
  return factors;
}

Schedule schedule(Algorithm algorithm, std::span<const Rank> order, std::span<const volume::Rect> footprints,
                  std::span<const int> factors) {
  Rounds rounds(order, footprints);
  const auto count = int(rounds.shown().size());
  if (count == 0) return rounds.finish();
  switch (algorithm) {
    case Algorithm::serial:
      break;
    case Algorithm::tree:
      pair_up(rounds);
      break;
    case Algorithm::direct_send:
      send_directly(rounds);
      break;
    case Algorithm::binary_swap:
      swap_halves(rounds);
      break;
    case Algorithm::radix_k: {
      const std::vector<int> usual = radix_factors(count);
      if (factors.empty()) factors = usual;
      if (std::accumulate(factors.begin(), factors.end(), 1, std::multiplies<>{}) != count)
        throw std::invalid_argument("the factors of a radix-k exchange must multiply to the number of images");
      exchange_in_groups(rounds, rounds.shown(), factors);
      break;
    }
  }
  return rounds.finish();
}

void write_gathered(Schedule& schedule, const std::vector<bool>& reached_by) {
  if (schedule.rounds.empty() || reached_by.empty()) return;
  std::vector<Piece>& pieces = schedule.rounds.back().pieces;
  for (auto piece = pieces.begin(); piece != pieces.end(); ++piece)
    for (auto other = pieces.begin(); other != piece; ++other)
      if (!intersection(piece->rect, other->rect).empty()) return;
  for (Piece& piece : pieces) piece.written = reached_by[std::size_t(piece.from)];
}

}  // namespace understudy::compositor
