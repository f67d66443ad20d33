// SPDX-License-Identifier: Apache-2.0
// Names that options, their values, environment variables and units had before they took the field's words.
// They are accepted for one release, and stand here alone.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace understudy::spu {

/// Of the folder that UNDERSTUDY_ENTRY_DIR names; for libraries that can link nothing.
inline constexpr const char* former_entry_folder_variable = "UNDERSTUDY_DOOR_DIR";

/// The launcher's arguments (program, subcommand, options) with every former option and value in today's words.
/// What is not known here stays as it is.
std::vector<std::string> with_present_options(const std::vector<std::string>& arguments);

/// What the environment says of `variable`: its own value, or where it is not set that of its former name, in
/// today's words. Nothing when neither is set.
std::optional<std::string> environment_value(const char* variable);

/// Puts the values of former variables where today's are looked for. For programs of our own, before they have
/// threads.
void rename_former_variables();

/// Today's names of a unit of a chain, and of one of its options.
std::string present_unit(std::string name);
std::string present_unit_option(std::string name);

}  // namespace understudy::spu
