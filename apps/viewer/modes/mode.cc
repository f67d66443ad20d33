// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/mode.h"

#include <array>
#include <utility>

#include "apps/viewer/modes/bricks.h"
#include "apps/viewer/modes/core.h"
#include "apps/viewer/modes/lit.h"
#include "apps/viewer/modes/preintegrated.h"
#include "apps/viewer/modes/rgba.h"
#include "apps/viewer/modes/stacks.h"
#include "apps/viewer/modes/table.h"
#include "apps/viewer/modes/time.h"

namespace viewer {

namespace {

constexpr std::array<std::pair<ModeKind, std::string_view>, 8> names = {{{ModeKind::rgba, "rgba"},
                                                                         {ModeKind::table, "table"},
                                                                         {ModeKind::core, "core"},
                                                                         {ModeKind::time, "time"},
                                                                         {ModeKind::bricks, "bricks"},
                                                                         {ModeKind::lit, "lit"},
                                                                         {ModeKind::preint, "preint"},
                                                                         {ModeKind::stacks, "stacks"}}};

}  // namespace

std::string_view name_of(ModeKind kind) {
  return names[static_cast<std::size_t>(kind)].second;
}

std::optional<ModeKind> mode_named(std::string_view name) {
  for (const auto& [kind, its_name] : names)
    if (its_name == name) return kind;
  return std::nullopt;
}

std::unique_ptr<Mode> make_mode(ModeKind kind, Texels texels, const std::string& file, TimeStep step) {
  switch (kind) {
    case ModeKind::rgba:
      return make_rgba_mode(std::move(texels), file);
    case ModeKind::table:
      return make_table_mode(texels, file);
    case ModeKind::core:
      return make_core_mode(texels, file);
    case ModeKind::time:
      return make_time_mode(texels, file, step);
    case ModeKind::bricks:
      return make_bricks_mode(texels, file);
    case ModeKind::lit:
      return make_lit_mode(texels, file);
    case ModeKind::preint:
      return make_preintegrated_mode(texels, file);
    case ModeKind::stacks:
      return make_stacks_mode(std::move(texels), file);
  }
  return nullptr;
}

}  // namespace viewer
