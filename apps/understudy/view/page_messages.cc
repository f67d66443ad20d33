// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/page_messages.h"

#include <array>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>

#include "apps/understudy/view/image_encoding.h"
#include "volume/cell_lattice.h"
#include "volume/description.h"
#include "volume/file/scalar_type.h"

namespace understudy::launcher {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr int moving_quality = 85;

Json json_of(const volume::TransferControlPoints& table, double low, double high) {
  Json control_points = Json::array();
  for (const volume::TransferControlPoints::ControlPoint& point : table.control_points) {
    // The page positions control points within the range, even if the file used values.
    const double at = table.of_values ? (point.at - low) / (high - low) : point.at;
    control_points.push_back({{"at", at}, {"colour", point.colour}, {"opacity", point.opacity}});
  }
  return control_points;
}

Json json_of(const ViewCamera& camera) {
  return {{"azimuth", camera.orbit.azimuth},
          {"elevation", camera.orbit.elevation},
          {"distance", camera.orbit.distance},
          {"roll", camera.orbit.roll},
          {"shift", camera.shift}};
}

/// Returns a box in texture space; the outer half texel belongs to the outermost cells.
Json json_of(const volume::TexelBox& cells, const volume::VolumeDescription& volume) {
  const volume::TexelBox all = volume::cell_lattice(volume).box();
  Json corners = Json::array({Json::array(), Json::array()});
  for (std::size_t k = 0; k < 3; ++k) {
    const double size = volume.size[k];
    corners[0].push_back(cells.low[k] <= all.low[k] ? 0.0 : (cells.low[k] + 0.5) / size);
    corners[1].push_back(cells.high[k] >= all.high[k] ? 1.0 : (cells.high[k] + 0.5) / size);
  }
  return corners;
}

/// Replaces invalid UTF-8, because names of files may be any bytes.
std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string status_message(Readiness readiness, std::string_view text, double part_done) {
  const char* const name = readiness == Readiness::loading ? "loading"
                           : readiness == Readiness::lost  ? "lost"
                                                           : "ready";
  return dumped({{"kind", "status"}, {"state", name}, {"text", text}, {"done", part_done}});
}

std::string volume_message(const ShownVolume& volume, const ViewState& state) {
  const FileScene& scene = volume.scene();
  const volume::TexelFigures& values = volume.values();
  const double low = values.low <= values.high ? values.low : 0.0;
  const double high = values.low < values.high ? values.high : low + 1;
  Json tables = Json::object();
  for (const std::string& name : volume::built_in_control_points_names())
    tables[name] = json_of(volume::control_points_named(name), low, high);
  Json surfaces = Json::array();
  for (const SurfaceChoice& surface : state.image().shading.surfaces)
    surfaces.push_back({{"at", surface.of_range ? surface.at : (surface.at - low) / (high - low)},
                        {"colour", {surface.colour[0], surface.colour[1], surface.colour[2]}},
                        {"opacity", surface.colour[3]}});
  const ShownVolume::Histogram& histogram = volume.histogram();
  return dumped(
      {{"kind", "volume"},
       {"name", volume::name_of({scene.load.file, std::nullopt})},
       {"size", scene.file.size},
       {"spacing", scene.file.spacing},
       {"type", volume::name_of(scene.file.type)},
       {"low", low},
       {"high", high},
       {"histogram", {{"low", histogram.low}, {"high", histogram.high}, {"counts", histogram.counts}}},
       {"tables", tables},
       {"table", json_of(state.image().control_points, low, high)},
       {"volume", state.image().shading.shows_volume},
       {"surfaces", surfaces},
       {"light", state.image().shading.light.has_value()},
       {"step", state.image().step},
       {"time_steps", scene.series.size()},
       {"time_step", state.time_step()},
       {"camera", json_of(state.camera())},
       {"nodes", volume.nodes()}});
}

std::string figures_message(std::uint64_t sequence, const FileScene& scene,
                            const std::optional<ShownVolume::Exactness>& exactness,
                            const std::vector<compositor::RankLoad>& ranks) {
  Json loads = Json::array();
  for (const compositor::RankLoad& rank : ranks)
    loads.push_back({{"box", json_of(rank.cells, scene.load.volume)},
                     {"ms", rank.image_ms},
                     {"samples", rank.image_samples},
                     {"bytes", rank.brick_bytes}});
  Json figures{{"kind", "figures"}, {"sequence", sequence}, {"ranks", loads}};
  if (exactness) {
    figures["error"] = exactness->error;
    figures["rays"] = exactness->rays;
  }
  return dumped(figures);
}

std::string refusal_message(std::uint64_t sequence, std::string_view reason) {
  return dumped({{"kind", "impossible"}, {"sequence", sequence}, {"text", reason}});
}

std::vector<std::byte> image_message(const FileScene& scene, const ViewState& state,
                                     const ShownVolume::Drawn& drawn) {
  const std::string name = volume::name_of(scene.series[std::size_t(state.time_step())]);
  const Clock::time_point start = Clock::now();
  const std::vector<std::byte> image =
      state.lossless() ? png_of(drawn.image) : jpeg_of(drawn.image, moving_quality);
  const std::string head =
      dumped({{"kind", "image"},
              {"sequence", state.sequence()},
              {"still", state.still()},
              {"width", drawn.image.width},
              {"height", drawn.image.height},
              {"time_step", state.time_step()},
              {"name", name},
              {"format", state.lossless() ? "png" : "jpeg"},
              {"camera", json_of(state.camera())},
              {"matrix", drawn.request.texture_to_clip},
              {"samples", drawn.counts.samples_taken},
              {"ms",
               {{"render", drawn.counts.render_ms},
                {"composite", drawn.counts.composite_ms},
                {"image", drawn.ms},
                {"load", drawn.load_ms},
                {"pack", std::chrono::duration<double, std::milli>(Clock::now() - start).count()}}}});
  std::vector<std::byte> message(4 + head.size() + image.size());
  for (std::size_t i = 0; i < 4; ++i) message[i] = std::byte(head.size() >> 8 * i & 255U);
  std::memcpy(message.data() + 4, head.data(), head.size());
  std::memcpy(message.data() + 4 + head.size(), image.data(), image.size());
  return message;
}

}  // namespace understudy::launcher
