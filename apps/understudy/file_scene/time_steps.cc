// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/time_steps.h"

#include <algorithm>

#include "compositor/service/limits.h"

namespace understudy::launcher {

using compositor::RankLoad;

namespace {

std::uint64_t most_brick_bytes(const std::vector<RankLoad>& ranks) {
  std::uint64_t most = 0;
  for (const RankLoad& rank : ranks) most = std::max(most, rank.brick_bytes);
  return most;
}

}  // namespace

std::size_t TimeSteps::loaded() const {
  return std::size_t(std::ranges::count_if(steps_, [](const auto& entry) { return entry.second.complete; }));
}

/// As large as the largest that is there.
std::uint64_t TimeSteps::bytes_of_a_step() const {
  std::uint64_t most = 0;
  for (const auto& [number, step] : steps_)
    if (step.complete) most = std::max(most, most_brick_bytes(step.ranks));
  return most;
}

bool TimeSteps::make_room(bool whatever_room) {
  // Beside what an application may hold, the one that is begun.
  constexpr std::size_t most_steps = compositor::limits::max_volumes_per_client - 1;
  while (true) {
    std::uint64_t held = bytes_of_a_step();
    for (const auto& [number, step] : steps_)
      held += step.complete ? most_brick_bytes(step.ranks) : bytes_of_a_step();
    if (steps_.size() <= most_steps && held <= bytes_of_rank_) return true;
    const auto oldest = std::ranges::min_element(steps_, {}, [&](const auto& entry) {
      return entry.first == shown_ && !whatever_room ? shows_ + 1 : entry.second.shown_at;
    });
    if (oldest == steps_.end()) return whatever_room;
    if (oldest->first == shown_ && !whatever_room) return false;
    service_.forget_volume(scene_.load_of(oldest->first).volume.id);
    steps_.erase(oldest);
  }
}

bool TimeSteps::begin(int step, bool whatever_room) {
  if (steps_.contains(step)) return true;
  if (!make_room(whatever_room)) return false;
  std::vector<RankLoad> ranks = service_.begin_load(scene_.load_of(step));
  const bool complete = std::ranges::all_of(ranks, &RankLoad::done);
  steps_[step] = {std::move(ranks), complete, shows_};
  return true;
}

void TimeSteps::read_on(int step) {
  Step& known = steps_.at(step);
  try {
    known.ranks = service_.continue_load(scene_.load_of(step).volume.id);
  } catch (...) {
    steps_.erase(step);
    throw;
  }
  known.complete = std::ranges::all_of(known.ranks, &RankLoad::done);
}

void TimeSteps::show(int step, const Progress& progress) {
  begin(step, true);
  while (!steps_.at(step).complete) {
    progress(steps_.at(step).ranks);
    read_on(step);
  }
  progress(steps_.at(step).ranks);
  shown_ = step;
  steps_.at(step).shown_at = ++shows_;
}

bool TimeSteps::read_ahead() {
  const int next = (shown_ + 1) % int(scene_.series.size());
  if (next == shown_) return false;
  const auto known = steps_.find(next);
  if (known != steps_.end() && known->second.complete) return false;
  if (known == steps_.end()) return begin(next, false);
  read_on(next);
  return true;
}

}  // namespace understudy::launcher
