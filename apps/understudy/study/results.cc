// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/study/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/understudy/processes/origin.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::launcher::study {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Point& point) {
  Json json{{"scheme", name_of(point.setting.scheme)},
            {"step", point.setting.step},
            {"termination", point.setting.termination},
            {"rms", point.error.rms},
            {"max", point.error.max},
            {"rms_colour", point.error.colour},
            {"rms_interval", point.error.interval},
            {"quantiles", point.error.quantiles},
            {"time_ms", nullptr},
            {"ns_per_ray", nullptr},
            {"samples_taken", point.samples_taken},
            {"samples", point.samples},
            {"front", point.front},
            {"time_quartiles_ms", point.quartiles},
            {"bound", nullptr}};
  if (point.bound > 0) json["bound"] = point.bound;
  if (point.time_ms > 0) {
    json["time_ms"] = point.time_ms;
    json["ns_per_ray"] = point.ns_per_ray;
  }
  return json;
}

Point point_of(const Json& json) {
  Point point;
  const auto scheme = std::ranges::find(all_schemes, json.at("scheme").get<std::string>(), name_of);
  if (scheme == all_schemes.end()) throw std::invalid_argument("unknown scheme");
  point.setting = {*scheme, json.at("step"), json.at("termination")};
  point.error = {json.at("max"), json.at("rms"), json.at("rms_colour"), json.at("rms_interval"),
                 json.at("quantiles")};
  if (!json.at("time_ms").is_null()) {
    point.time_ms = json.at("time_ms");
    point.ns_per_ray = json.at("ns_per_ray");
  }
  point.samples_taken = json.at("samples_taken");
  point.samples = json.at("samples");
  point.quartiles = json.at("time_quartiles_ms");
  if (!json.at("bound").is_null()) point.bound = json.at("bound");
  return point;
}

Json json_of(const Saving& saving) {
  return {{"item", saving.item},
          {"unit", saving.unit},
          {"shown", saving.shown},
          {"left_out", saving.left_out},
          {"all", saving.all},
          {"time_ms", saving.ms},
          {"time_ms_without", saving.ms_without},
          {"difference", saving.difference},
          {"tolerance", saving.tolerance},
          {"absent", saving.absent}};
}

Saving saving_of(const Json& json) {
  return {json.at("item"),      json.at("unit"),    json.at("shown"),           json.at("left_out"),
          json.at("all"),       json.at("time_ms"), json.at("time_ms_without"), json.at("difference"),
          json.at("tolerance"), json.at("absent")};
}

Json json_of(const std::optional<Ratio>& ratio) {
  return ratio ? Json{{"value", ratio->value}, {"at_least", ratio->at_least}} : Json(nullptr);
}

Json json_of(const SceneResults& scene) {
  Json json{{"name", scene.name},
            {"shows", scene.shows},
            {"volume", scene.volume},
            {"size", scene.size},
            {"rays", scene.rays},
            {"reference_seconds", scene.reference_seconds},
            {"stiffness", {{"depth", scene.stiffness.depth}, {"change", scene.stiffness.change}}},
            {"orders", Json::object()},
            {"error_maps", scene.error_maps},
            {"advantages", Json::object()},
            {"absent", scene.absent},
            {"points", Json::array()},
            {"savings", Json::array()}};
  for (const Scheme scheme : all_schemes)
    if (const auto advantage = advantage_over(scene.points, scheme); advantage && is_other_program(scheme))
      json["advantages"][name_of(scheme)] = {{"time_ratio", json_of(advantage->time)},
                                             {"error_ratio", json_of(advantage->error)}};
  for (const Scheme scheme : {Scheme::post_classified, Scheme::pre_integrated, Scheme::adaptive})
    if (const auto order = observed_order(scene.points, scheme))
      json["orders"][name_of(scheme)] = {{"slope", order->slope}, {"steps", order->steps}};
  for (const Point& point : scene.points) json["points"].push_back(json_of(point));
  for (const Saving& saving : scene.savings) json["savings"].push_back(json_of(saving));
  return json;
}

SceneResults scene_of(const Json& json) {
  SceneResults scene;
  scene.name = json.at("name");
  scene.shows = json.at("shows");
  scene.volume = json.at("volume");
  scene.size = json.at("size");
  scene.rays = json.at("rays");
  scene.reference_seconds = json.at("reference_seconds");
  scene.stiffness = {json.at("stiffness").at("depth"), json.at("stiffness").at("change")};
  scene.error_maps = json.at("error_maps");
  scene.absent = json.at("absent");
  for (const Json& point : json.at("points")) scene.points.push_back(point_of(point));
  for (const Json& saving : json.value("savings", Json::array())) scene.savings.push_back(saving_of(saving));
  return scene;
}

std::string row_of(const SceneResults& scene, const Point& point) {
  const Setting& setting = point.setting;
  const Difference& error = point.error;
  std::string row =
      fmt::format("{},{},{:g},{:g}", scene.name, name_of(setting.scheme), setting.step, setting.termination);
  for (const double figure : {error.rms, error.interval[0], error.interval[1], error.colour, error.quantiles[0],
                              error.quantiles[1], error.quantiles[2], error.max, point.bound, point.time_ms,
                              point.quartiles[0], point.quartiles[1], point.ns_per_ray})
    row += fmt::format(",{:.4g}", figure);
  return row + fmt::format(",{},{},{:.4g},{:.4g},{:d}\n", point.samples_taken, point.samples,
                           scene.stiffness.depth, scene.stiffness.change, point.front);
}

void write(const std::filesystem::path& path, const std::string& text) {
  // Written to a temporary file first: an interrupted study leaves the last complete file.
  const std::filesystem::path part = path.string() + ".part";
  std::ofstream file(part, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error(part.string() + ": cannot be written; check that the disk is not full");
  std::filesystem::rename(part, path);
}

}  // namespace

const Point* SceneResults::find(const Setting& setting) const {
  const auto found = std::ranges::find(points, setting, &Point::setting);
  return found == points.end() ? nullptr : &*found;
}

std::string text_of(const Setting& setting) {
  if (is_other_program(setting.scheme)) return name_of(setting.scheme);
  std::string text = fmt::format("{}, step {:g}", name_of(setting.scheme), setting.step);
  if (setting.termination > 1e-4) text += fmt::format(", ends below {:g}", setting.termination);
  return text;
}

Results read_results(const std::filesystem::path& folder, int edge, int stride) {
  Results results{edge, stride, {}};
  std::ifstream file(folder / "study.json");
  if (!file) return results;
  try {
    const Json json = Json::parse(file);
    if (json.at("edge") != edge || json.at("stride") != stride ||
        json.at("instruction_set") != volume::instruction_set())
      return results;
    for (const Json& scene : json.at("scenes")) results.scenes.push_back(scene_of(scene));
  } catch (const std::exception&) {
    // From another version, or not a study: measure everything again.
    results.scenes.clear();
  }
  return results;
}

void write_results(const std::filesystem::path& folder, const Results& results) {
  Json json{{"origin", origin()},
            {"edge", results.edge},
            {"stride", results.stride},
            {"cameras", Json::array()},
            {"instruction_set", volume::instruction_set()},
            {"scenes", Json::array()}};
  for (const volume::OrbitCamera& camera : Scene::cameras())
    json["cameras"].push_back(
        {{"azimuth", camera.azimuth}, {"elevation", camera.elevation}, {"distance", camera.distance}});
  std::string csv =
      "scene,scheme,step,termination,rms,rms_low,rms_high,rms_colour,median,p95,p99,max,bound,time_ms,time_q1_"
      "ms,"
      "time_q3_ms,ns_per_ray,samples_taken,samples,depth,change,front\n";
  for (const SceneResults& scene : results.scenes) {
    json["scenes"].push_back(json_of(scene));
    for (const Point& point : scene.points) csv += row_of(scene, point);
  }
  std::string savings = "scene,item,unit,left_out,all,time_ms,time_ms_without,difference,tolerance,shown\n";
  for (const SceneResults& scene : results.scenes)
    for (const Saving& saving : scene.savings)
      if (saving.absent.empty())
        savings += fmt::format("{},{},{},{},{},{:.4g},{:.4g},{:.4g},{:.4g},\"{}\"\n", scene.name, saving.item,
                               saving.unit, saving.left_out, saving.all, saving.ms, saving.ms_without,
                               saving.difference, saving.tolerance, saving.shown);
  write(folder / "study.json", json.dump(1) + "\n");
  write(folder / "left_out.csv", savings);
  write(folder / "study.csv", csv);
}

}  // namespace understudy::launcher::study
