// SPDX-License-Identifier: Apache-2.0
// Holds the time steps of a series as volumes of one service: keeps the steps shown last as far as memory
// allows, and reads the next one ahead.
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
  /// `service` and `scene` must outlive this object. The bricks of all steps take at most `memory`, except that
  /// the step shown is always kept.
  TimeSteps(compositor::LoadingService& service, const FileScene& scene, const VolumeMemory& memory);

  /// May throw: then the step is not shown, but what has been read of it is kept.
  using Progress = std::function<void(const std::vector<compositor::RankLoad>&)>;
  /// Loads `step`, to be shown. If the service has too little memory, the steps shown longest ago are removed.
  /// Throws as the service does.
  void show(int step, const Progress& progress);

  /// Reads a further part of the step after the one shown last; the first step follows the last
  /// one. Removes no step of `in_use`. Returns false if the step is loaded, cannot be read, or does
  /// not fit. Throws ServiceLost.
  bool read_ahead(std::span<const int> in_use);

  /// The step shown last, unless it has been removed.
  std::optional<int> shown() const { return shown_; }
  compositor::LoadRequest load_of(int step) const;
  volume::VolumeId volume_of(int step) const { return load_of(step).volume.id; }

  /// Number of completely loaded steps.
  std::size_t loaded() const;

 private:
  struct Step {
    std::vector<compositor::RankLoad> ranks;
    bool complete = false;
    std::uint64_t shown_at = 0;  ///< when it was shown last, as a count of steps shown
  };

  void begin(int step);
  /// Reads a further part of the step.
  void read_on(int step);
  void forget(int step);
  /// The next step to remove: unfinished ones first, then those shown longest ago; never
  /// `step` or one of `in_use`.
  std::optional<int> least_wanted(int step, std::span<const int> in_use) const;
  /// Removes steps until one more fits; returns false if that is impossible.
  bool make_room(int step, std::span<const int> in_use);
  std::uint64_t bytes_of(const std::vector<compositor::RankLoad>& ranks) const;

  compositor::LoadingService& service_;
  const FileScene& scene_;
  std::uint64_t most_bytes_;
  bool of_each_rank_;  ///< memory is counted on the rank with the most bytes, otherwise over all ranks
  std::map<int, Step> steps_;
  std::set<int> failed_;            ///< could not be read, regardless of memory
  std::uint64_t largest_step_ = 0;  ///< bytes
  std::optional<int> shown_;
  std::uint64_t shows_ = 0;
};

}  // namespace understudy::launcher
