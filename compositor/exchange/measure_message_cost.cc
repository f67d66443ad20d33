// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/measure_message_cost.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

#include "compositor/blend.h"
#include "volume/blending_operator.h"

namespace understudy::compositor {

namespace {

using Clock = std::chrono::steady_clock;

/// No connection is faster than memory.
constexpr double least_per_byte = 0.02e-9;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Returns half the shortest round trip of `bytes` in `rounds` rounds.
double one_way(Communicator& communicator, Rank other, std::vector<std::byte>& bytes, int rounds) {
  double shortest = std::numeric_limits<double>::max();
  for (int round = 0; round < rounds; ++round) {
    const auto start = Clock::now();
    if (communicator.rank() == 0) {
      const Outgoing there{other, bytes};
      const Incoming back{other, bytes};
      communicator.transfer({&there, 1}, {});
      communicator.transfer({}, {&back, 1});
    } else if (communicator.rank() == other) {
      const Outgoing back{0, bytes};
      const Incoming there{0, bytes};
      communicator.transfer({}, {&there, 1});
      communicator.transfer({&back, 1}, {});
    }
    shortest = std::min(shortest, seconds_since(start) / 2);
  }
  return shortest;
}

/// Returns the shortest time in which `bytes` go from every rank to the next, all at once.
double all_ways(Communicator& communicator, std::vector<std::byte>& bytes, std::vector<std::byte>& room) {
  constexpr int rounds = 4;
  const Rank next = (communicator.rank() + 1) % communicator.size();
  const Rank previous = (communicator.rank() + communicator.size() - 1) % communicator.size();
  double shortest = std::numeric_limits<double>::max();
  for (int round = 0; round < rounds; ++round) {
    const auto start = Clock::now();
    const Outgoing there{next, bytes};
    const Incoming here{previous, room};
    communicator.transfer({&there, 1}, {&here, 1});
    // A rank is done when its neighbours are; the round is done when all ranks are.
    double slowest = seconds_since(start);
    std::vector<double> all(std::size_t(communicator.size()));
    communicator.gather_to_all(bytes_of(slowest), std::as_writable_bytes(std::span(all)));
    shortest = std::min(shortest, *std::ranges::max_element(all));
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

}  // namespace

MessageCost measure_message_cost(Communicator& communicator) {
  MessageCost measured;
  if (communicator.size() > 1) {
    constexpr std::size_t large = std::size_t(1) << 20;
    const Rank last = communicator.size() - 1;
    std::vector<std::byte> small_message(1), large_message(large);
    // If ranks share a processor, most rounds of a small message wait for other ranks to yield it.
    const double latency = one_way(communicator, last, small_message, 64);
    const double transfer = one_way(communicator, last, large_message, 8);
    measured.latency = latency;
    measured.per_byte = std::max(least_per_byte, (transfer - latency) / double(large));
    measured.per_pixel = seconds_per_blended_pixel();
    std::vector<std::byte> room(large);
    measured.ranks_at_once =
        std::clamp(double(communicator.size()) * transfer / all_ways(communicator, large_message, room), 1.0,
                   double(communicator.size()));
    communicator.broadcast(0, bytes_of(measured));
  }
  return measured;
}

}  // namespace understudy::compositor
