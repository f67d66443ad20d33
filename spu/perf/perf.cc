// SPDX-License-Identifier: Apache-2.0
#include "spu/perf/perf.h"

#include "dispatch/call_words.h"
#include "spu/report/counters.h"
#include "spu/shared_by_file.h"
#include "spu/stream/argument_bytes.h"

namespace understudy::spu {
namespace {

std::uint64_t nanoseconds_since(std::chrono::steady_clock::time_point start) {
  return std::uint64_t(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start).count());
}

}  // namespace

struct Perf::Counted {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    Perf& perf = *Chain::current()->find<Perf>();
    const std::uint64_t bytes = call_bytes(call, words);
    const std::atomic<std::uint64_t>& round_trips = perf.round_trips_;
    const std::uint64_t round_trips_before = round_trips.load(std::memory_order_relaxed);
    const Clock::time_point start = Clock::now();
    const std::uint64_t result = invoke(perf.chain_.below(perf), call, words);
    const std::uint64_t nanoseconds = nanoseconds_since(start);
    const std::uint64_t waited = round_trips.load(std::memory_order_relaxed) - round_trips_before;
    for (CallFigures* figures : {&perf.figures_.by_call[std::size_t(call)], &perf.frame_}) {
      figures->calls.add(1);
      figures->nanoseconds.add(nanoseconds);
      figures->bytes.add(bytes);
      if (waited != 0) figures->round_trips.add(waited);
    }
    return result;
  }
};

Perf::Perf(Chain& chain, const std::string& file)
    : chain_(chain),
      file_(shared_by_file<PerfFile>(file)),
      figures_(file_.begin_context()),
      round_trips_(process_counters().remote.round_trips) {}

Perf::~Perf() {
  abandon();
}

void Perf::fill(Phase, DispatchTable& table) {
  AsWords<Counted>::fill(table);
}

void Perf::frame_ended(FrameEnd kind) {
  if (kind != FrameEnd::swap && kind != FrameEnd::finish) return;
  figures_.frame_nanoseconds.add(nanoseconds_since(frame_started_));
  frame_started_ = Clock::now();
  figures_.frames.add(1);
  figures_.in_frames.add(frame_);
  figures_.largest.keep_largest(frame_);
  frame_ = {};
  file_.write_when_due();
}

void Perf::abandon() {
  if (abandoned_) return;
  abandoned_ = true;
  file_.end_context(figures_);
}

namespace {

constexpr UnitOption perf_options[] = {
    {.name = "file",
     .type = OptionType::file,
     .fallback = "",
     .help = "file for the table, as JSON if its name ends in .json; default: standard error"}};

}  // namespace

constinit const UnitDescription perf_description{
    .name = "perf",
    .help = "counts calls, their time and their bytes, by command and by frame",
    .options = perf_options,
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Perf>(place.chain, place.options.text("file"));
    }};

}  // namespace understudy::spu
