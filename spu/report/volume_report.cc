// SPDX-License-Identifier: Apache-2.0
#include "spu/report/volume_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "spu/report/counters.h"
#include "spu/report/keys.h"

namespace understudy::spu {
namespace {

using Json = nlohmann::ordered_json;

Json verified(const VolumeCounters& volume) {
  const std::uint64_t frames = volume.verified_frames.load();
  const std::uint64_t tiles = volume.verified_tiles.load();
  Json json{{report_key::frames, frames},
            {report_key::tiles, tiles},
            {report_key::lost, volume.verify_lost.load()},
            {report_key::worst_tile, nullptr},
            {report_key::worst_frame, nullptr},
            {report_key::max, nullptr},
            {report_key::rms, nullptr},
            {report_key::psnr, nullptr}};
  if (frames + tiles > 0) {
    json[report_key::worst_tile] = volume.verify_worst_tile;
    json[report_key::worst_frame] = volume.verify_worst_frame;
  }
  if (frames > 0) {
    const double rms = verified_rms(volume);
    json[report_key::max] = volume.verify_max;
    json[report_key::rms] = rms;
    if (rms > 0) json[report_key::psnr] = -20 * std::log10(rms);
  }
  return json;
}

Json exported(const VolumeCounters& volume) {
  const std::string scene = text_in(volume.scene);
  const std::string because = text_in(volume.not_exported);
  if (scene.empty() && because.empty()) return nullptr;
  return {{report_key::scene, scene.empty() ? Json(nullptr) : Json(scene)},
          {report_key::because, because.empty() ? Json(nullptr) : Json(because)}};
}

}  // namespace

Json report_of(const BudgetCounters& budget) {
  if (!has_budget(budget)) return nullptr;
  const auto or_null = [](double value) { return value > 0 ? Json(value) : Json(nullptr); };
  return {{report_key::asked, or_null(budget.asked_error)},
          {report_key::asked_ms, or_null(budget.asked_ms)},
          {report_key::measured, budget.calibrations > 0 ? Json(budget.measured) : Json(nullptr)},
          {report_key::time, or_null(budget.ms)},
          {report_key::setting, text_in(budget.setting)},
          {report_key::rays_integrated, budget.rays},
          {report_key::images_over, budget.images_over},
          {report_key::calibrations, budget.calibrations},
          {report_key::note, text_in(budget.note)}};
}

ReasonCounts counts_in(std::span<const ReasonCount> counted) {
  ReasonCounts reasons;
  for (const ReasonCount& reason : counted) {
    if (const std::uint64_t count = reason.count.load(); count > 0) reasons[text_in(reason.reason)] += count;
  }
  return reasons;
}

ReasonCounts reasons_of(const VolumeCounters& volume) {
  return counts_in(volume.left_because);
}

double verified_rms(const VolumeCounters& volume) {
  const auto frames = static_cast<double>(volume.verified_frames.load());
  return frames > 0 ? std::sqrt(volume.verify_sum_sq / frames) : 0;
}

bool has_budget(const BudgetCounters& budget) {
  return budget.asked_error > 0 || budget.asked_ms > 0;
}

std::string sentence_of(const BudgetCounters& budget) {
  std::string asked;
  if (budget.asked_error > 0) {
    asked = fmt::format("error asked {:.4f}", budget.asked_error);
  } else {
    asked = fmt::format("time asked {:.4g} ms, taken {:.4g} ms", budget.asked_ms, budget.ms);
  }
  // A run may end before the first calibration does.
  if (budget.setting[0] != '\0')
    asked += fmt::format(", {} {:.4f} ({:.3g} ms an image, {})",
                         budget.asked_error > 0 ? "measured" : "error measured", budget.measured, budget.ms,
                         text_in(budget.setting));
  if (budget.note[0] != '\0') asked += "; " + text_in(budget.note);
  return asked;
}

Json report_of(const VolumeCounters& volume, std::int32_t pid) {
  Json because = Json::object();
  for (const auto& [reason, count] : reasons_of(volume)) because[reason] = count;
  return {{report_key::pid, pid},
          {report_key::texture, volume.texture},
          {report_key::size, volume.size},
          {report_key::texture_format, text_in(volume.texture_format)},
          {report_key::draws,
           {{report_key::substituted, volume.draws_substituted.load()},
            {report_key::left, volume.draws_left.load()}}},
          {report_key::probes, volume.probes.load()},
          {report_key::texels,
           {{report_key::bytes_sent, volume.texel_bytes_sent.load()},
            {report_key::bytes_left_out, volume.texel_bytes_left_out.load()}}},
          {report_key::left_because, because},
          {report_key::verify, verified(volume)},
          {report_key::budget, report_of(volume.budget)},
          {report_key::exported, exported(volume)},
          {report_key::explanation, text_in(volume.explanation)}};
}

}  // namespace understudy::spu
