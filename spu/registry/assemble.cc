// SPDX-License-Identifier: Apache-2.0
#include "spu/registry/assemble.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <exception>
#include <vector>

#include "spu/chain_json.h"
#include "spu/chain_text.h"
#include "spu/driver/driver.h"
#include "spu/null/null.h"
#include "spu/pack/pack.h"
#include "spu/pass/pass.h"
#include "spu/perf/perf.h"
#include "spu/plugin/plugin_file.h"
#include "spu/print/print.h"
#include "spu/remote/remote.h"
#include "spu/tiles/tile.h"
#include "spu/tiles/tiles.h"
#include "spu/trace/trace.h"
#include "spu/track/description.h"
#include "spu/unpack/unpack.h"
#include "spu/volume/description.h"

namespace understudy::spu {
namespace {

namespace fs = std::filesystem;

constexpr std::array units_by_name = {
    &driver_description, &null_description,   &pack_description,  &pass_description,  &perf_description,
    &print_description,  &remote_description, &tile_description,  &tiles_description, &trace_description,
    &track_description,  &unpack_description, &volume_description};

struct PlannedUnit {
  UnitDescription description;
  OptionValues options;
};

ChainSettings settings_of(std::string_view description) {
  if (description.starts_with('@')) return read_chain_file(std::string(description.substr(1)));
  if (description.ends_with(".json") && description.find('(') == std::string_view::npos) {
    return read_chain_file(std::string(description));
  }
  return parse_chain(description);
}

/// The file of a unit that is built elsewhere; null if the unit is one of `units` or does not exist.
std::optional<fs::path> plugin_of(const UnitSetting& setting, UnitTable units) {
  if (names_plugin_file(setting.name)) return setting.name;
  if (std::ranges::any_of(units, [&](const UnitDescription* unit) { return setting.name == unit->name; }))
    return std::nullopt;
  return find_plugin(setting.name);
}

UnitDescription find_unit(const UnitSetting& setting, UnitTable units) {
  for (const UnitDescription* unit : units) {
    if (setting.name == unit->name) return *unit;
  }
  if (const auto file = plugin_of(setting, units)) {
    try {
      const UnitDescription plugin = load_plugin(*file);
      if (!std::ranges::any_of(
              units, [&](const UnitDescription* unit) { return std::string_view(unit->name) == plugin.name; }))
        return plugin;
      throw std::runtime_error(
          fmt::format("{} has the name of a unit of Understudy's own: {}", file->string(), plugin.name));
    } catch (const std::runtime_error& error) {
      throw ChainError(setting.where, error.what());
    }
  }
  std::vector<std::string> names;
  for (const UnitDescription* unit : units) names.emplace_back(unit->name);
  const std::string meant = nearest_name(setting.name, names);
  throw ChainError(setting.where,
                   fmt::format("no unit is named {0}{1} There are: {2}; and {0}.so would be one in a folder of "
                               "UNDERSTUDY_PLUGINS",
                               shown(setting.name), meant.empty() ? "." : "; did you mean " + meant + "?",
                               fmt::join(names, ", ")));
}

std::vector<PlannedUnit> plan(const ChainSettings& settings, UnitTable units) {
  std::vector<PlannedUnit> planned;
  for (const UnitSetting& setting : settings) {
    const UnitDescription unit = find_unit(setting, units);
    const auto is_planned = [&](std::string_view name) {
      return std::any_of(planned.begin(), planned.end(),
                         [&](const PlannedUnit& before) { return name == before.description.name; });
    };
    if (!planned.empty() && planned.back().description.position == UnitPosition::last) {
      throw ChainError(setting.where, fmt::format("{} stands behind {}, which must be last; move it before",
                                                  unit.name, planned.back().description.name));
    }
    if (unit.position == UnitPosition::once && is_planned(unit.name)) {
      throw ChainError(setting.where,
                       fmt::format("{} can stand only once in a chain, and is there already", unit.name));
    }
    if (unit.needs != nullptr && !is_planned(unit.needs)) {
      throw ChainError(setting.where,
                       fmt::format("{0} needs {1} before it; write \"{1} {0}\"", unit.name, unit.needs));
    }
    planned.push_back({unit, option_values(setting, unit.options)});
  }
  for (std::size_t i = 0; i < planned.size(); ++i) {
    const char* wanted = planned[i].description.leads_to;
    const char* otherwise = planned[i].description.or_leads_to;
    const auto is_wanted = [&](const PlannedUnit& unit) {
      const std::string_view name = unit.description.name;
      return name == wanted || (otherwise != nullptr && name == otherwise);
    };
    if (wanted == nullptr || std::any_of(planned.begin() + std::ptrdiff_t(i), planned.end(), is_wanted))
      continue;
    throw ChainError(settings[i].where, fmt::format("{0} needs {1} behind it; write \"{0} {1}\"",
                                                    planned[i].description.name, wanted));
  }
  if (planned.empty() || planned.back().description.position != UnitPosition::last) {
    throw ChainError(settings.empty() ? "chain" : settings.back().where,
                     "the chain must end in driver, the real OpenGL; write it last");
  }
  return planned;
}

/// Calls `take` for each setting that names a file.
template <typename Take>
void for_each_file(ChainSettings& settings, UnitTable units, const Take& take) {
  for (UnitSetting& unit : settings) {
    const UnitDescription description = find_unit(unit, units);
    for (const UnitOption& option : description.options) {
      if (option.type != OptionType::file) continue;
      for (OptionSetting& setting : unit.options) {
        if (setting.name == option.name && !setting.value.empty()) take(setting);
      }
    }
  }
}

}  // namespace

UnitTable unit_table() {
  return units_by_name;
}

std::optional<std::string> assemble(Chain& chain, std::string_view description,
                                    const std::shared_ptr<RenderSession>& session, UnitTable units) {
  try {
    for (const PlannedUnit& unit : plan(settings_of(description), units)) {
      if (unit.description.make != nullptr)
        chain.add(unit.description.make({chain, unit.description, unit.options, session}));
    }
  } catch (const std::exception& error) {
    // Units that were already added rely on those after them.
    chain.remove_units();
    return error.what();
  }
  return std::nullopt;
}

std::string resolved_chain(std::string_view description, const std::filesystem::path& folder, UnitTable units) {
  ChainSettings settings = settings_of(description);
  plan(settings, units);
  for_each_file(settings, units, [&](OptionSetting& setting) { setting.value = folder / setting.value; });
  // The viewer's process may have another working folder and other folders of plugins.
  for (UnitSetting& setting : settings) {
    if (const auto file = plugin_of(setting, units)) setting.name = folder / *file;
  }
  return chain_text(settings);
}

std::vector<std::filesystem::path> files_of_units(std::string_view resolved, UnitTable units) {
  ChainSettings settings = settings_of(resolved);
  std::vector<std::filesystem::path> files;
  for_each_file(settings, units, [&](const OptionSetting& setting) { files.emplace_back(setting.value); });
  return files;
}

}  // namespace understudy::spu
