// SPDX-License-Identifier: Apache-2.0
// The time steps of a series as volumes of one service: those that were shown last stay there as far as memory
// allows, and the next one is read ahead.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "apps/understudy/file_scene/file_scene.h"
#include "compositor/service/loading_service.h"

namespace understudy::launcher {

class TimeSteps {
 public:
  /// Both outlive this. Each rank keeps at most so many bytes of bricks, but always what is shown.
  TimeSteps(compositor::LoadingService& service, const FileScene& scene, std::uint64_t bytes_of_rank)
      : service_(service), scene_(scene), bytes_of_rank_(bytes_of_rank) {}

  using Progress = std::function<void(const std::vector<compositor::RankLoad>&)>;
  /// Has `step` there, to be shown. Throws as the service does.
  void show(int step, const Progress& progress);

  /// Reads some more of the step behind the one that was shown last; behind the last comes the first. False: it
  /// is there, or there is no room for it. Throws as the service does.
  bool read_ahead();

  /// Of the step that was shown last.
  int shown() const { return shown_; }
  compositor::LoadRequest shown_load() const { return scene_.load_of(shown_); }

  /// Steps that are there, for the report and for tests.
  std::size_t loaded() const;

 private:
  struct Step {
    std::vector<compositor::RankLoad> ranks;
    bool complete = false;
    std::uint64_t shown_at = 0;  ///< when it was shown last, counted in steps shown
  };

  /// Begins it, with room for it made of steps that were shown longest ago; false: there is no room, and
  /// nothing was begun.
  bool begin(int step, bool whatever_room);
  bool make_room(bool whatever_room);
  /// A part of it is read.
  void read_on(int step);
  std::uint64_t bytes_of_a_step() const;

  compositor::LoadingService& service_;
  const FileScene& scene_;
  std::uint64_t bytes_of_rank_;
  std::map<int, Step> steps_;
  int shown_ = 0;
  std::uint64_t shows_ = 0;
};

}  // namespace understudy::launcher
