// SPDX-License-Identifier: Apache-2.0
#include "spu/perf/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

namespace understudy::spu {
namespace {

using Json = nlohmann::ordered_json;

std::vector<CallId> calls_made(const Figures& figures) {
  std::vector<CallId> made;
  for (std::size_t i = 0; i < call_count; ++i) {
    if (figures.by_call[i].calls.get() > 0) made.push_back(CallId(i));
  }
  const auto costs = [&](CallId call) { return figures.by_call[std::size_t(call)].nanoseconds.get(); };
  std::stable_sort(made.begin(), made.end(), [&](CallId a, CallId b) { return costs(a) > costs(b); });
  return made;
}

double milliseconds(const Count& nanoseconds) {
  return double(nanoseconds.get()) / 1e6;
}

double per(double amount, std::uint64_t count) {
  return count > 0 ? amount / double(count) : 0;
}

}  // namespace

void CallFigures::add(const CallFigures& other) {
  calls.add(other.calls.get());
  nanoseconds.add(other.nanoseconds.get());
  bytes.add(other.bytes.get());
  round_trips.add(other.round_trips.get());
}

void CallFigures::keep_largest(const CallFigures& other) {
  calls.set(std::max(calls.get(), other.calls.get()));
  nanoseconds.set(std::max(nanoseconds.get(), other.nanoseconds.get()));
  bytes.set(std::max(bytes.get(), other.bytes.get()));
  round_trips.set(std::max(round_trips.get(), other.round_trips.get()));
}

void Figures::add(const Figures& other) {
  for (std::size_t i = 0; i < call_count; ++i) by_call[i].add(other.by_call[i]);
  frames.add(other.frames.get());
  in_frames.add(other.in_frames);
  largest.keep_largest(other.largest);
  frame_nanoseconds.add(other.frame_nanoseconds.get());
}

CallFigures Figures::total() const {
  CallFigures sum;
  for (const CallFigures& call : by_call) sum.add(call);
  return sum;
}

std::string figures_text(const Figures& figures) {
  const CallFigures all = figures.total();
  // If OpenGL is in the same process, there are no round trips to show.
  const bool travels = all.round_trips.get() > 0;
  std::string text = fmt::format("{:40} {:>12} {:>12} {:>10} {:>14}{}\n", "call", "calls", "ms", "ns a call",
                                 "bytes", travels ? "  round trips" : "");
  const auto row = [&](const char* name, const CallFigures& call) {
    text += fmt::format("{:40} {:>12} {:>12.3f} {:>10.0f} {:>14}", name, call.calls.get(),
                        milliseconds(call.nanoseconds), per(double(call.nanoseconds.get()), call.calls.get()),
                        call.bytes.get());
    text += travels ? fmt::format(" {:>12}\n", call.round_trips.get()) : "\n";
  };
  for (const CallId call : calls_made(figures)) row(call_name(call), figures.by_call[std::size_t(call)]);
  row("all", all);
  const std::uint64_t frames = figures.frames.get();
  if (frames == 0) return text;
  const auto a_frame = [&](const Count& count) { return per(double(count.get()), frames); };
  text += fmt::format(
      "{} frames of {:.3f} ms; in each {:.0f} calls (at most {}), {:.3f} ms in them (at most {:.3f}), {:.0f} "
      "bytes (at most {})",
      frames, per(milliseconds(figures.frame_nanoseconds), frames), a_frame(figures.in_frames.calls),
      figures.largest.calls.get(), per(milliseconds(figures.in_frames.nanoseconds), frames),
      milliseconds(figures.largest.nanoseconds), a_frame(figures.in_frames.bytes), figures.largest.bytes.get());
  if (travels) {
    text += fmt::format(", {:.2f} round trips (at most {})", a_frame(figures.in_frames.round_trips),
                        figures.largest.round_trips.get());
  }
  return text + "\n";
}

std::string figures_json(const Figures& figures) {
  const auto object = [](const CallFigures& call) {
    return Json{{"calls", call.calls.get()},
                {"time_ms", milliseconds(call.nanoseconds)},
                {"bytes", call.bytes.get()},
                {"round_trips", call.round_trips.get()}};
  };
  Json calls = Json::object();
  for (const CallId call : calls_made(figures))
    calls[call_name(call)] = object(figures.by_call[std::size_t(call)]);
  const std::uint64_t frames = figures.frames.get();
  const Json mean{{"calls", per(double(figures.in_frames.calls.get()), frames)},
                  {"time_ms", per(milliseconds(figures.in_frames.nanoseconds), frames)},
                  {"bytes", per(double(figures.in_frames.bytes.get()), frames)},
                  {"round_trips", per(double(figures.in_frames.round_trips.get()), frames)}};
  const Json json{{"calls", calls},     {"all", object(figures.total())},
                  {"frames", frames},   {"frame_ms", per(milliseconds(figures.frame_nanoseconds), frames)},
                  {"frame_mean", mean}, {"frame_largest", object(figures.largest)}};
  return json.dump(1) + "\n";
}

}  // namespace understudy::spu
