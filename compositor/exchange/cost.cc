#include "compositor/exchange/cost.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

#include "compositor/blend.h"

namespace understudy::compositor {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The shortest way there and back of `bytes`, halved.
double one_way(Link& link, Rank other, std::vector<std::byte>& bytes) {
  constexpr int rounds = 8;
  double shortest = std::numeric_limits<double>::max();
  for (int round = 0; round < rounds; ++round) {
    const auto start = Clock::now();
    if (link.rank() == 0) {
      const Outgoing there{other, bytes};
      const Incoming back{other, bytes};
      link.transfer({&there, 1}, {});
      link.transfer({}, {&back, 1});
    } else if (link.rank() == other) {
      const Outgoing back{0, bytes};
      const Incoming there{0, bytes};
      link.transfer({}, {&there, 1});
      link.transfer({&back, 1}, {});
    }
    shortest = std::min(shortest, seconds_since(start) / 2);
  }
  return shortest;
}

double seconds_per_blended_pixel() {
  constexpr std::size_t pixels = 1 << 16;
  std::vector<float> front(4 * pixels, 0.0F);
  const std::vector<float> back(4 * pixels, 0.25F);
  double shortest = std::numeric_limits<double>::max();
  for (int round = 0; round < 4; ++round) {
    const auto start = Clock::now();
    blend(volume::Operator::over, front, back);
    shortest = std::min(shortest, seconds_since(start));
  }
  return shortest / double(pixels);
}

/// What one rank does in one round.
struct Work {
  std::uint64_t messages_out = 0, messages_in = 0, pixels_out = 0, pixels_in = 0, blended = 0;
  int contributions = 0;
};

}  // namespace

ExchangeCost cost(const Schedule& schedule, Layout layout, const LinkCost& link) {
  ExchangeCost result;
  std::vector<std::uint64_t> sent(schedule.position.size(), 0);
  for (const Round& round : schedule.rounds) {
    std::vector<Work> work(schedule.position.size());
    for (const Piece& piece : round.pieces) {
      Work& to = work[std::size_t(piece.to)];
      to.blended += piece.rect.pixels();
      ++to.contributions;
      if (piece.from == piece.to) continue;
      Work& from = work[std::size_t(piece.from)];
      ++from.messages_out;
      ++to.messages_in;
      from.pixels_out += piece.rect.pixels();
      to.pixels_in += piece.rect.pixels();
      ++result.messages;
      result.pixels_sent += piece.rect.pixels();
      sent[std::size_t(piece.from)] += piece.rect.pixels();
    }
    double slowest = 0;
    for (const Work& mine : work) {
      const double blended = mine.contributions > 1 ? double(mine.blended) : 0;
      slowest = std::max(slowest, link.latency * double(std::max(mine.messages_out, mine.messages_in)) +
                                      link.per_byte * double(bytes_per_pixel(layout)) *
                                          double(std::max(mine.pixels_out, mine.pixels_in)) +
                                      link.per_pixel * blended);
    }
    result.seconds += slowest;
  }
  if (!sent.empty()) result.most_pixels_sent = *std::ranges::max_element(sent);
  return result;
}

Schedule cheapest(std::span<const Rank> order, std::span<const volume::Rect> footprints, Layout layout,
                  const LinkCost& link) {
  Schedule best;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < algorithm_count; ++i) {
    Schedule candidate = schedule(Algorithm(i), order, footprints);
    const double seconds = cost(candidate, layout, link).seconds;
    if (seconds >= least) continue;
    least = seconds;
    best = std::move(candidate);
  }
  return best;
}

LinkCost measure_link(Link& link) {
  LinkCost measured;
  if (link.size() > 1) {
    constexpr std::size_t large = std::size_t(1) << 20;
    const Rank last = link.size() - 1;
    std::vector<std::byte> small_message(1), large_message(large);
    const double latency = one_way(link, last, small_message);
    const double transfer = one_way(link, last, large_message);
    measured.latency = latency;
    measured.per_byte = std::max(0.0, transfer - latency) / double(large);
    measured.per_pixel = seconds_per_blended_pixel();
    link.broadcast(0, bytes_of(measured));
  }
  return measured;
}

}  // namespace understudy::compositor
