// SPDX-License-Identifier: Apache-2.0
// Former names of options, their values, environment variables and units, before they took the field's terms.
// They are accepted for one release, and are listed only here.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace understudy::spu {

/// Former name of the variable UNDERSTUDY_ENTRY_DIR, for libraries that cannot link anything.
inline constexpr const char* former_entry_folder_variable = "UNDERSTUDY_DOOR_DIR";

/// Returns the launcher's arguments (program, subcommand, options) with all former options and values replaced
/// by the present ones. Other arguments are unchanged.
std::vector<std::string> with_present_options(const std::vector<std::string>& arguments);

/// Returns the value of `variable`, or if it is not set, the value of the variable of its former name, with
/// former words replaced. Nothing if neither is set.
std::optional<std::string> environment_value(const char* variable);

/// Sets the present variables from variables with former names, and unsets those. For our own programs, before
/// they start threads.
void rename_former_variables();

/// The present names of a unit of a chain and of one of its options; other names are unchanged.
std::string present_unit(std::string name);
std::string present_unit_option(std::string name);

}  // namespace understudy::spu
