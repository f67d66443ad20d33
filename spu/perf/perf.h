// SPDX-License-Identifier: Apache-2.0
// The perf unit: counts every call, its time and its bytes, per call and per frame.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

#include "spu/perf/figures.h"
#include "spu/perf/perf_file.h"
#include "spu/unit_description.h"

namespace understudy::spu {

class Perf final : public Unit {
 public:
  static constexpr char tag = 'p';

  Perf(Chain& chain, const std::string& file);
  ~Perf() override;

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void frame_ended(FrameEnd kind) override;
  void abandon() override;
  void process_ends() override { file_.write(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Counted;

  Chain& chain_;
  PerfFile& file_;
  Figures& figures_;
  /// Counter of the process: threads that wait at the same time may count each other's round trips.
  const std::atomic<std::uint64_t>& round_trips_;
  CallFigures frame_;  ///< the current frame
  Clock::time_point frame_started_ = Clock::now();
  bool abandoned_ = false;
};

extern const UnitDescription perf_description;

}  // namespace understudy::spu
