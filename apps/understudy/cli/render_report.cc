// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/render_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/processes/origin.h"
#include "apps/understudy/study/median.h"
#include "spu/report/volume_report.h"

namespace understudy::launcher {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(volume::TexelType type) {
  return type == volume::TexelType::u8 ? "u8" : type == volume::TexelType::u16 ? "u16" : "f32";
}

/// Returns "12 MiB", or "8 to 12 MiB" if ranks differ.
template <class Figure>
std::string over_ranks(const std::vector<compositor::RankLoad>& ranks, Figure figure) {
  const auto [least, most] = std::ranges::minmax(ranks, {}, figure);
  const auto text = [](std::uint64_t bytes) {
    return bytes < 10U << 20U ? fmt::format("{:.1f}", double(bytes) / (1 << 20)) : std::to_string(bytes >> 20U);
  };
  const std::string low = text(std::invoke(figure, least)), high = text(std::invoke(figure, most));
  return low == high ? high + " MiB" : fmt::format("{} to {} MiB", low, high);
}

/// Lists surfaces by their values in the volume's own units.
Json image_json(const RenderFigures& figures) {
  const volume::RenderRequest& request = figures.request;
  Json surfaces = Json::array();
  const double units = figures.mapping.normalised(figures.mapping.offset + figures.mapping.scale);
  for (const volume::Surface& surface : request.surfaces)
    surfaces.push_back({{"value", figures.mapping.offset + figures.mapping.scale * surface.value / units},
                        {"colour", surface.colour}});
  const char* const method = request.method == volume::Method::pre_integrated ? "pre-integrated"
                             : request.method == volume::Method::adaptive     ? "adaptive"
                                                                              : "post-classified";
  const char* const op = request.op == volume::Operator::first_hit ? "first-hit"
                         : request.op == volume::Operator::max     ? "max"
                         : request.op == volume::Operator::add     ? "add"
                                                                   : "over";
  return {{"width", figures.width},
          {"height", figures.height},
          {"step", figures.step},
          {"method", method},
          {"operator", op},
          {"surfaces", surfaces},
          {"light", !request.light              ? "none"
                    : request.light->on_samples ? "all"
                                                : "surfaces"}};
}

Json level_json(const volume::FileDescription& description) {
  if (!description.detail) return nullptr;
  const volume::LevelOfDetail& detail = *description.detail;
  return {{"level", detail.level},
          {"volume_size", detail.volume_size},
          {"value_error", std::isfinite(detail.error) ? Json(detail.error) : Json()}};
}

}  // namespace

std::string summary_text(const RenderFigures& figures) {
  const auto& size = figures.description.size;
  const volume::FrameCounts& counts = figures.counts;
  const double left_out =
      counts.samples == 0 ? 0 : 100 * (1 - double(counts.samples_taken) / double(counts.samples));
  std::string text = fmt::format(
      "understudy: {} x {} x {} of {}, {}: loaded in {:.0f} ms, {} of {:.1f} ms; {:.1f} % of {:.1f} million "
      "samples skipped, {} of {} blocks empty\n",
      size[0], size[1], size[2], volume::name_of(figures.description.type),
      figures.nodes == 0 ? "in this process" : fmt::format("{} nodes", figures.nodes), figures.load_ms,
      figures.frame_ms.size() == 1 ? "1 frame" : fmt::format("{} frames", figures.frame_ms.size()),
      median(figures.frame_ms), left_out, double(counts.samples) / 1e6, counts.blocks_empty, counts.blocks);
  text += fmt::format("understudy: each rank read {}, holds {} of bricks, and used at most {} of memory\n",
                      over_ranks(figures.ranks, &compositor::RankLoad::bytes_read),
                      over_ranks(figures.ranks, &compositor::RankLoad::brick_bytes),
                      over_ranks(figures.ranks, &compositor::RankLoad::peak_bytes));
  if (const compositor::PassFigures& passes = figures.passes; passes.passes > 1)
    text += fmt::format(
        "understudy: rendered in {} parts within the memory limit of each rank, with {} loads of parts; "
        "skipped {} parts without anything visible, and {} behind opaque ones\n",
        passes.passes, passes.loads, passes.empty, passes.hidden);
  if (const auto& detail = figures.description.detail)
    text +=
        fmt::format("understudy: level {} of a volume of {} x {} x {}: {}\n", detail->level,
                    detail->volume_size[0], detail->volume_size[1], detail->volume_size[2],
                    std::isfinite(detail->error) ? fmt::format("largest error of a value {:.4g}", detail->error)
                                                 : "no error bound: some values are not finite numbers");
  if (figures.bound)
    text += fmt::format(
        "understudy: certified: every channel of every pixel is within {:.3g} of the integral{}, and of half "
        "the "
        "pixels within {:.3g}; computing these bounds took {:.0f} ms\n",
        figures.bound->greatest,
        figures.bound->asked > 0
            ? fmt::format(" (asked: {:.3g}; step {:.3g})", figures.bound->asked, figures.step)
            : "",
        figures.bound->median, figures.bound->time_ms);
  if (spu::has_budget(figures.budget))
    text += fmt::format("understudy: {}\n", spu::sentence_of(figures.budget));
  const volume::TexelFigures texels = texel_figures(figures.ranks);
  if (texels.largest_error > 0 || texels.not_numbers > 0)
    text += fmt::format(
        "understudy: values {:g} to {:g} were converted to {} texels, with errors of at most {:.3g}; {} values "
        "are not numbers\n",
        texels.low, texels.high, name_of(figures.mapping.type), texels.largest_error, texels.not_numbers);
  return text;
}

void write_render_report(const std::string& path, const RenderFigures& figures) {
  const volume::TexelFigures texels = texel_figures(figures.ranks);
  const volume::FrameCounts& counts = figures.counts;
  Json report;
  report["volume"] = {
      {"file", figures.file},
      {"time_step", figures.time_step},
      {"channel", figures.channel ? Json(*figures.channel) : Json()},
      {"size", figures.description.size},
      {"spacing", figures.description.spacing},
      {"level_of_detail", level_json(figures.description)},
      {"scalar_type", std::string(volume::name_of(figures.description.type))},
      {"texel_type", name_of(figures.mapping.type)},
      {"scale", figures.mapping.scale},
      {"offset", figures.mapping.offset},
      {"values", texels.low <= texels.high ? Json{texels.low, texels.high} : Json()},
      {"largest_conversion_error", std::isfinite(texels.largest_error) ? Json(texels.largest_error) : Json()},
      {"not_numbers", texels.not_numbers}};
  report["image"] = image_json(figures);
  report["nodes"] = figures.nodes;
  report["backends"] = figures.backends;
  report["time_ms"] = {{"open", figures.open_ms},
                       {"load", figures.load_ms},
                       {"frame_median", median(figures.frame_ms)},
                       {"division", counts.division_ms},
                       {"render", counts.render_ms},
                       {"processors", counts.processor_ms},
                       {"composite", counts.composite_ms}};
  report["frames_ms"] = figures.frame_ms;
  report["passes"] = {{"parts", figures.passes.passes},
                      {"loads", figures.passes.loads},
                      {"empty", figures.passes.empty},
                      {"hidden", figures.passes.hidden},
                      {"load_ms", figures.passes.load_ms}};
  report["budget"] = spu::report_of(figures.budget);
  report["error_bound"] = nullptr;
  if (figures.bound)
    report["error_bound"] = {{"asked", figures.bound->asked > 0 ? Json(figures.bound->asked) : Json()},
                             {"greatest", figures.bound->greatest},
                             {"median", figures.bound->median},
                             {"time_ms", figures.bound->time_ms}};
  report["origin"] = origin();
  report["samples"] = counts.samples;
  report["samples_taken"] = counts.samples_taken;
  report["rays"] = counts.rays;
  report["blocks"] = counts.blocks;
  report["bytes_exchanged"] = counts.bytes_exchanged;
  report["left_out"] = {{"samples_skipped", counts.samples - std::min(counts.samples, counts.samples_taken)},
                        {"rays_ended_early", counts.rays_terminated},
                        {"blocks_empty", counts.blocks_empty},
                        {"nodes_idle", counts.nodes_idle}};
  report["ranks"] = Json::array();
  for (const compositor::RankLoad& rank : figures.ranks)
    report["ranks"].push_back({{"texels", rank.texels_in_all},
                               {"bytes_read", rank.bytes_read},
                               {"brick_bytes", rank.brick_bytes},
                               {"peak_bytes", rank.peak_bytes},
                               {"image_ms", rank.image_ms},
                               {"image_processor_ms", rank.image_processor_ms},
                               {"samples_taken", rank.image_samples}});
  std::ofstream file(path);
  file << report.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  file.close();
  if (!file)
    throw std::runtime_error(fmt::format(
        "{}: the report cannot be written; check that the folder exists and the disk is not full", path));
}

}  // namespace understudy::launcher
