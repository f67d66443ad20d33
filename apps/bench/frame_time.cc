// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/frame_time.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace understudy::bench {

using compositor::CountedExchange;
using compositor::CountedMessage;
using compositor::CountedRound;
using compositor::RankTraffic;

namespace {

/// Returns the time until the last of several jobs ends. All start together and share the cores evenly; each
/// runs on at most `threads` cores.
double shared_time(std::vector<double> jobs, int cores, int threads) {
  std::ranges::sort(jobs);
  double now = 0, done = 0;  // `done`: work done by each job that is still running
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const double speed = std::min(double(threads), double(cores) / double(jobs.size() - i));
    now += (jobs[i] - done) / speed;
    done = jobs[i];
  }
  return now;
}

/// The processors: one for each rank, or a few shared by all ranks.
class Cores {
 public:
  Cores(std::size_t ranks, int shared) : shared_(shared > 0), free_(shared_ ? std::size_t(shared) : ranks) {}

  /// Returns when a piece of work of `rank` ends that could begin at `ready`.
  double work(std::size_t rank, double ready, double seconds) {
    double& core = shared_ ? *std::ranges::min_element(free_) : free_[rank];
    core = std::max(core, ready) + seconds;
    return core;
  }

 private:
  bool shared_;
  std::vector<double> free_;
};

/// Returns the ranks in the order in which they become ready.
std::vector<std::size_t> by_time(const std::vector<double>& ready) {
  std::vector<std::size_t> order(ready.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order, {}, [&](std::size_t rank) { return ready[rank]; });
  return order;
}

class Clock {
 public:
  Clock(std::size_t ranks, const Costs& costs) : costs_(costs), ready_(ranks), cores_(ranks, costs.cores) {}

  /// Advances the clock by one round: ranks pack all messages, send and receive them, then
  /// blend, as Player::play() does.
  void play(const CountedRound& round) {
    const std::size_t ranks = ready_.size();
    std::vector<double> sent = ready_;
    for (const std::size_t rank : by_time(ready_)) {
      const RankTraffic& work = round.ranks[rank];
      if (work.messages_sent == 0 && work.pixels_written == 0) continue;
      sent[rank] = cores_.work(rank, ready_[rank],
                               costs_.overhead * double(work.messages_sent) +
                                   costs_.per_byte_packed * double(work.bytes_sent) +
                                   costs_.per_pixel_written * double(work.pixels_written));
    }
    std::vector<double> line_out = sent;
    std::vector<std::vector<Arrival>> arrivals(ranks);
    for (const CountedMessage& message : round.messages) {
      double& free = line_out[std::size_t(message.from)];
      const double on_line = costs_.per_byte * double(message.bytes);
      arrivals[std::size_t(message.to)].push_back({free + costs_.latency + on_line, on_line});
      free += std::max(costs_.gap, on_line);
    }
    std::vector<double> complete(ranks);
    for (std::size_t rank = 0; rank < ranks; ++rank) {
      std::ranges::sort(arrivals[rank], {}, &Arrival::at);
      double line_in = 0;
      complete[rank] = line_out[rank];
      for (const Arrival& arrival : arrivals[rank]) {
        const double here = std::max(arrival.at, line_in);
        line_in = here + std::max(costs_.gap, arrival.on_line);
        complete[rank] = std::max(complete[rank], here);
      }
    }
    for (const std::size_t rank : by_time(complete)) {
      const RankTraffic& work = round.ranks[rank];
      const double seconds = costs_.overhead * double(work.messages_received) +
                             costs_.per_byte_unpacked * double(work.bytes_received) +
                             costs_.per_pixel_blended * double(work.pixels_blended);
      ready_[rank] = seconds > 0 ? cores_.work(rank, complete[rank], seconds) : complete[rank];
    }
  }

  double of_rank_0() const { return ready_.front(); }

 private:
  struct Arrival {
    double at = 0;
    double on_line = 0;
  };

  const Costs& costs_;
  std::vector<double> ready_;
  Cores cores_;
};

double work_of(const RankPart& part, const Costs& costs) {
  return costs.per_sample * double(part.samples) + costs.per_pixel_cast * double(part.cast.pixels());
}

}  // namespace

FrameTime time_of(const FrameParts& parts, const CountedExchange& exchange, const Costs& costs) {
  FrameTime time;
  std::vector<double> jobs;
  for (const RankPart& part : parts.ranks) jobs.push_back(work_of(part, costs));
  const int threads = costs.cores > 0 ? std::max(1, costs.cores / int(jobs.size())) : 1;
  time.render =
      costs.cores > 0 ? shared_time(std::move(jobs), costs.cores, threads) : *std::ranges::max_element(jobs);
  Clock clock(parts.ranks.size(), costs);
  for (const CountedRound& round : exchange.rounds) clock.play(round);
  time.exchange = clock.of_rank_0();
  return time;
}

double time_on_one_rank(const FrameParts& parts, const Costs& costs) {
  return costs.per_sample * double(parts.samples()) / std::max(1, costs.cores);
}

}  // namespace understudy::bench
