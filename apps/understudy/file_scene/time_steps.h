// SPDX-License-Identifier: Apache-2.0
// The time steps of a series as volumes of one service: those that were shown last stay there as far as memory
// allows, and the next one is read ahead.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/file_scene/volume_memory.h"
#include "compositor/service/loading_service.h"

namespace understudy::launcher {

class TimeSteps {
 public:
  /// Both outlive this. The bricks of all steps take no more than `memory`, but what is shown is always there.
  TimeSteps(compositor::LoadingService& service, const FileScene& scene, const VolumeMemory& memory);

  /// May throw: then the step is not shown, and what was read of it is kept.
  using Progress = std::function<void(const std::vector<compositor::RankLoad>&)>;
  /// Has `step` there, to be shown. Where the service has no room for it, steps that were shown longest ago are
  /// forgotten. Throws as the service does.
  void show(int step, const Progress& progress);

  /// Reads some more of the step after the one that was shown last; after the last comes the first. No step of
  /// `in_use` is forgotten for it. False: it is there, cannot be read, or there is no room for it. Throws
  /// ServiceLost.
  bool read_ahead(std::span<const int> in_use);

  /// The step that was shown last, as long as it is there.
  std::optional<int> shown() const { return shown_; }
  compositor::LoadRequest load_of(int step) const;
  volume::VolumeId volume_of(int step) const { return load_of(step).volume.id; }

  /// How many are there, complete.
  std::size_t loaded() const;

 private:
  struct Step {
    std::vector<compositor::RankLoad> ranks;
    bool complete = false;
    std::uint64_t shown_at = 0;  ///< when it was shown last, counted in steps shown
  };

  void begin(int step);
  /// A part of it is read.
  void read_on(int step);
  void forget(int step);
  /// The first to go: unfinished ones, then those that were shown longest ago; none but of `in_use` and `step`.
  std::optional<int> least_wanted(int step, std::span<const int> in_use) const;
  /// Forgets steps until there is room for one more; false: there is none.
  bool make_room(int step, std::span<const int> in_use);
  std::uint64_t bytes_of(const std::vector<compositor::RankLoad>& ranks) const;

  compositor::LoadingService& service_;
  const FileScene& scene_;
  std::uint64_t most_bytes_;
  bool of_each_rank_;  ///< bytes are those of the rank with the most, or else of all together
  std::map<int, Step> steps_;
  std::set<int> failed_;            ///< could not be read, whatever room there was
  std::uint64_t largest_step_ = 0;  ///< bytes
  std::optional<int> shown_;
  std::uint64_t shows_ = 0;
};

}  // namespace understudy::launcher
