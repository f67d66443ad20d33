// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/control/viewer_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "spu/report/keys.h"

namespace understudy::launcher {
namespace {

using Json = nlohmann::ordered_json;
namespace key = spu::control_key;
namespace report_key = spu::report_key;

/// A value of another process's answer; null if it is missing.
Json value(const Json& answer, const std::string& pointer) {
  const Json::json_pointer place(pointer);
  return answer.contains(place) ? answer.at(place) : Json();
}

double number(const Json& json) {
  return json.is_number() ? json.get<double>() : 0;
}

Json volumes_of(const Json& report) {
  Json volumes = Json::array();
  for (const Json& volume : value(report, "/volumes")) {
    volumes.push_back({{report_key::texture, value(volume, "/texture")},
                       {report_key::substituted, value(volume, "/draws/substituted")},
                       {report_key::left, value(volume, "/draws/left")},
                       {report_key::left_because, value(volume, "/left_because")}});
  }
  return volumes;
}

/// The worst of all comparisons; null if there was none.
Json worst_tile(const Json& report) {
  Json worst;
  for (const Json& volume : value(report, "/volumes")) {
    const Json tile = value(volume, "/verify/worst_tile");
    if (tile.is_number() && (worst.is_null() || number(tile) > number(worst))) worst = tile;
  }
  return worst;
}

/// Time of frames that Understudy drew, relative to that of frames that the viewer drew; null if either is
/// unknown.
Json time_ratio(const Json& report) {
  const Json ours = value(report, "/time_ms/substituted_median");
  const Json own = value(report, "/time_ms/application_median");
  return ours.is_number() && number(own) > 0 ? Json(number(ours) / number(own)) : Json();
}

std::string milliseconds(const Json& time) {
  return time.is_number() ? fmt::format("{:.4g} ms", number(time)) : "?";
}

std::string reasons_text(const Json& reasons) {
  std::string text;
  for (const auto& [reason, count] : reasons.items())
    text += fmt::format("{}{} ({}x)", text.empty() ? ": " : "; ", reason, std::uint64_t(number(count)));
  return text;
}

}  // namespace

Json summary_of(const RunningViewer& viewer) {
  const Json report = value(viewer.answer, "/report");
  return {{report_key::pid, viewer.process},
          {report_key::program, value(report, "/processes/0/program")},
          {"socket", viewer.socket.string()},
          {key::since, value(viewer.answer, "/control/since")},
          {key::control, value(viewer.answer, "/control")},
          {report_key::frames, value(report, "/frames")},
          {report_key::frames_substituted, value(report, "/frames_substituted")},
          {report_key::frames_left, value(report, "/frames_left")},
          {report_key::volumes, volumes_of(report)},
          {report_key::time_ms, value(report, "/time_ms")},
          {"time_ratio", time_ratio(report)},
          {report_key::nodes, value(report, "/nodes")},
          {report_key::worst_tile, worst_tile(report)}};
}

std::string summary_text(const RunningViewer& viewer) {
  const Json summary = summary_of(viewer);
  const auto count = [&](const char* name) { return std::uint64_t(number(summary[name])); };
  std::string text = fmt::format("{:<8}{}, since {}, {}\n", viewer.process, viewer.program(),
                                 summary[key::since].is_string() ? summary[key::since].get<std::string>() : "?",
                                 settings_text(summary[key::control]));
  text += fmt::format("        {} frames: {} substituted, {} not substituted; {} a frame",
                      count(report_key::frames), count(report_key::frames_substituted),
                      count(report_key::frames_left), milliseconds(value(summary, "/time_ms/frame_median")));
  if (const std::uint64_t nodes = count(report_key::nodes); nodes > 0)
    text += fmt::format(" on {} node{}", nodes, nodes == 1 ? "" : "s");
  if (const Json& ratio = summary["time_ratio"]; ratio.is_number())
    text += fmt::format(", substituted ones {:.2f} times the viewer's own", number(ratio));
  if (const Json& tile = summary[report_key::worst_tile]; tile.is_number())
    text += fmt::format("; worst tile {:.2f} of the bound", number(tile));
  text += "\n";
  for (const Json& volume : summary[report_key::volumes])
    text += fmt::format("        volume of texture {}: {} draws substituted, {} left{}\n",
                        volume[report_key::texture].dump(), volume[report_key::substituted].dump(),
                        volume[report_key::left].dump(), reasons_text(volume[report_key::left_because]));
  return text;
}

Json status_of(const RunningViewer& viewer) {
  Json status = value(viewer.answer, "/report");
  status[key::control] = value(viewer.answer, "/control");
  return status;
}

std::string settings_text(const Json& control) {
  const auto on = [&](const char* pointer) { return value(control, pointer) == true ? "on" : "off"; };
  std::string budget = "no budget";
  if (const Json error = value(control, "/error"); error.is_number()) {
    budget = fmt::format("error {:.4f}", number(error));
  } else if (const Json time = value(control, "/time_ms"); time.is_number()) {
    budget = fmt::format("time {:.4g} ms", number(time));
  }
  return fmt::format("substitution {}, tint {}, {}", on("/substitution"), on("/tint"), budget);
}

}  // namespace understudy::launcher
