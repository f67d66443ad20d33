// SPDX-License-Identifier: Apache-2.0
// What the report, the summary and the explanation contain about one volume.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "spu/report/skipped_work.h"

namespace understudy::spu {

struct BudgetCounters;
struct ReasonCount;
struct VolumeCounters;

/// Reads a fixed field whose closing zero a dying process may not have written.
template <std::size_t size>
std::string text_in(const char (&field)[size]) {
  return {field, strnlen(field, size)};
}

ReasonCounts counts_in(std::span<const ReasonCount> counted);
/// Why draws of the volume were not substituted.
ReasonCounts reasons_of(const VolumeCounters& volume);

nlohmann::ordered_json report_of(const VolumeCounters& volume, std::int32_t pid);

/// Over all verified frames.
double verified_rms(const VolumeCounters& volume);

bool has_budget(const BudgetCounters& budget);
/// Null without a budget.
nlohmann::ordered_json report_of(const BudgetCounters& budget);
/// "error asked 0.0020, measured 0.0013", with the setting, or why the budget is not kept.
std::string sentence_of(const BudgetCounters& budget);

}  // namespace understudy::spu
