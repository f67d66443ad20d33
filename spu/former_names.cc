// SPDX-License-Identifier: Apache-2.0
#include "spu/former_names.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>

namespace understudy::spu {
namespace {

struct Renamed {
  std::string_view former;
  std::string_view present;
};

struct RenamedOption {
  Renamed flag;
  const char* former_variable;  ///< null: no former variable
  const char* variable;
  std::array<Renamed, 3> values;   ///< of the former option or variable
  std::string_view commands = {};  ///< separated by spaces, if only these subcommands had the former name
};

constexpr std::array renamed_options{
    RenamedOption{{"--polygons", "--tiles"},
                  "UNDERSTUDY_POLYGONS",
                  "UNDERSTUDY_TILES",
                  {{{"strips", "on"}, {"root", "off"}}}},
    RenamedOption{{"--home", "--gather"}, "UNDERSTUDY_HOME", "UNDERSTUDY_GATHER", {{{"gathered", "root"}}}},
    RenamedOption{{"--pipeline", "--frame-latency"}, "UNDERSTUDY_PIPELINE", "UNDERSTUDY_FRAME_LATENCY", {}},
    RenamedOption{{"--never-leave-out", "--disable-optimization"},
                  "UNDERSTUDY_NEVER_LEAVE_OUT",
                  "UNDERSTUDY_DISABLE_OPTIMIZATION",
                  {{{"empty-blocks", "empty-bricks"},
                    {"lesser-samples", "dominated-samples"},
                    {"unchanged-pictures", "unchanged-images"}}}},
    RenamedOption{{"--stage", "--gl-server"}, nullptr, nullptr, {}},
    RenamedOption{
        {"--stage-opengl", "--server-opengl"}, "UNDERSTUDY_STAGE_OPENGL", "UNDERSTUDY_SERVER_OPENGL", {}},
    RenamedOption{{"--door", "--injection"}, nullptr, nullptr, {}},
    RenamedOption{{"--table", "--transfer-function"}, nullptr, nullptr, {}, " render view "},
};

constexpr std::array renamed_units{Renamed{"link", "remote"}, Renamed{"strips", "tiles"},
                                   Renamed{"strip", "tile"}};
constexpr std::array renamed_unit_options{Renamed{"stages", "gl-server"}};

template <std::size_t count>
std::string present_name(const std::array<Renamed, count>& names, std::string name) {
  const auto found = std::ranges::find(names, name, &Renamed::former);
  return found == names.end() || name.empty() ? name : std::string(found->present);
}

/// Replaces every entry of a comma-separated list.
std::string present_value(const RenamedOption& option, std::string_view list) {
  std::string present;
  for (;;) {
    const std::size_t comma = list.find(',');
    present += present_name(option.values, std::string(list.substr(0, comma)));
    if (comma == std::string_view::npos) return present;
    present += ',';
    list.remove_prefix(comma + 1);
  }
}

const RenamedOption* option_with_flag(std::string_view flag, const std::string& command) {
  const auto found = std::ranges::find_if(renamed_options, [&](const RenamedOption& option) {
    return option.flag.former == flag &&
           (option.commands.empty() || option.commands.find(" " + command + " ") != std::string_view::npos);
  });
  return found == renamed_options.end() ? nullptr : &*found;
}

}  // namespace

std::vector<std::string> with_present_options(const std::vector<std::string>& arguments) {
  std::vector<std::string> present;
  const std::string command = arguments.size() > 1 ? arguments[1] : "";
  const RenamedOption* before = nullptr;  // the option whose value is the next argument
  for (const std::string& argument : arguments) {
    const std::size_t equals = argument.find('=');
    const RenamedOption* option = option_with_flag(argument.substr(0, equals), command);
    if (option == nullptr) {
      present.push_back(before != nullptr ? present_value(*before, argument) : argument);
    } else if (equals == std::string::npos) {
      present.emplace_back(option->flag.present);
    } else {
      present.push_back(std::string(option->flag.present) + "=" +
                        present_value(*option, std::string_view(argument).substr(equals + 1)));
    }
    before = equals == std::string::npos ? option : nullptr;
  }
  return present;
}

std::optional<std::string> environment_value(const char* variable) {
  if (const char* text = ::secure_getenv(variable)) return text;
  for (const RenamedOption& option : renamed_options) {
    if (option.variable == nullptr || std::string_view(option.variable) != variable) continue;
    if (const char* text = ::secure_getenv(option.former_variable)) return present_value(option, text);
  }
  return std::nullopt;
}

void rename_former_variables() {
  for (const RenamedOption& option : renamed_options) {
    if (option.variable == nullptr || ::secure_getenv(option.former_variable) == nullptr) continue;
    setenv(option.variable, environment_value(option.variable)->c_str(), 1);
    unsetenv(option.former_variable);
  }
}

std::string present_unit(std::string name) {
  return present_name(renamed_units, std::move(name));
}

std::string present_unit_option(std::string name) {
  return present_name(renamed_unit_options, std::move(name));
}

}  // namespace understudy::spu
