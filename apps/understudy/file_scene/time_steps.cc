// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/time_steps.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "compositor/service/limits.h"
#include "volume/cell_lattice.h"

namespace understudy::launcher {
namespace {

using compositor::RankLoad;

std::uint64_t product(std::uint64_t bytes, int ranks) {
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  return bytes > most / std::uint64_t(ranks) ? most : bytes * std::uint64_t(ranks);
}

}  // namespace

TimeSteps::TimeSteps(compositor::LoadingService& service, const FileScene& scene, const VolumeMemory& memory)
    : service_(service), scene_(scene), most_bytes_(memory.bytes), of_each_rank_(memory.of_each_process) {
  if (!of_each_rank_) most_bytes_ = product(memory.bytes, std::max(1, service.nodes()));
}

compositor::LoadRequest TimeSteps::load_of(int step) const {
  compositor::LoadRequest load = scene_.load_of(step);
  // A part is divided among all ranks, whereas one rank may keep a whole volume for the others.
  if (of_each_rank_ && service_.nodes() > 1) load.volume.part = volume::shown_cells(load.volume);
  return load;
}

std::size_t TimeSteps::loaded() const {
  return std::size_t(std::ranges::count_if(steps_, [](const auto& entry) { return entry.second.complete; }));
}

std::uint64_t TimeSteps::bytes_of(const std::vector<RankLoad>& ranks) const {
  std::uint64_t most = 0, all = 0;
  for (const RankLoad& rank : ranks) {
    most = std::max(most, rank.brick_bytes);
    all += rank.brick_bytes;
  }
  return of_each_rank_ ? most : all;
}

void TimeSteps::forget(int step) {
  service_.forget_volume(volume_of(step));
  steps_.erase(step);
  if (shown_ == step) shown_.reset();
}

std::optional<int> TimeSteps::least_wanted(int step, std::span<const int> in_use) const {
  std::optional<int> least;
  const auto rank = [&](int number) {
    const Step& of = steps_.at(number);
    return std::tuple(of.complete, of.shown_at, number);
  };
  for (const auto& [number, unused] : steps_) {
    if (number == step || std::ranges::find(in_use, number) != in_use.end()) continue;
    if (!least || rank(number) < rank(*least)) least = number;
  }
  return least;
}

bool TimeSteps::make_room(int step, std::span<const int> in_use) {
  const auto fits = [&] {
    std::uint64_t held = largest_step_;
    for (const auto& [number, of] : steps_) held += of.complete ? bytes_of(of.ranks) : largest_step_;
    // The step to be loaded also counts against the limit of volumes per client.
    return steps_.size() < compositor::limits::max_volumes_per_client && held <= most_bytes_;
  };
  while (!fits()) {
    const auto least = least_wanted(step, in_use);
    if (!least) return false;
    forget(*least);
  }
  return true;
}

void TimeSteps::begin(int step) {
  std::vector<RankLoad> ranks = service_.begin_load(load_of(step));
  const bool complete = std::ranges::all_of(ranks, &RankLoad::done);
  steps_[step] = {std::move(ranks), complete, shows_};
}

void TimeSteps::read_on(int step) {
  Step& known = steps_.at(step);
  try {
    known.ranks = service_.continue_load(volume_of(step));
  } catch (const compositor::RequestRefused&) {
    forget(step);
    throw;
  }
  known.complete = std::ranges::all_of(known.ranks, &RankLoad::done);
  if (known.complete) largest_step_ = std::max(largest_step_, bytes_of(known.ranks));
}

void TimeSteps::show(int step, const Progress& progress) {
  while (true) {
    try {
      if (!steps_.contains(step)) {
        make_room(step, {});
        begin(step);
      }
      while (!steps_.at(step).complete) {
        progress(steps_.at(step).ranks);
        read_on(step);
      }
      break;
    } catch (const compositor::RequestRefused&) {
      // The service may have less memory than assumed.
      const auto least = failed_.contains(step) ? std::nullopt : least_wanted(step, {});
      if (!least) {
        failed_.insert(step);
        throw;
      }
      forget(*least);
    }
  }
  failed_.erase(step);
  shown_ = step;
  steps_.at(step).shown_at = ++shows_;
  progress(steps_.at(step).ranks);
}

bool TimeSteps::read_ahead(std::span<const int> in_use) {
  if (!shown_ || scene_.series.size() < 2) return false;
  const int next = (*shown_ + 1) % int(scene_.series.size());
  const auto known = steps_.find(next);
  if (failed_.contains(next) || (known != steps_.end() && known->second.complete)) return false;
  try {
    if (known != steps_.end()) {
      read_on(next);
      return true;
    }
    std::vector<int> kept(in_use.begin(), in_use.end());
    kept.push_back(*shown_);
    if (!make_room(next, kept)) return false;
    begin(next);
    return true;
  } catch (const compositor::RequestRefused&) {
    failed_.insert(next);  // show() reports it when the step is requested
    return false;
  }
}

}  // namespace understudy::launcher
