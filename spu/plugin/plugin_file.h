// SPDX-License-Identifier: Apache-2.0
// Units in shared libraries (unit_plugin.h): how they are searched for and loaded.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "spu/unit_description.h"

namespace understudy::spu {

/// Whether a name in a chain is a file rather than a unit: it contains a slash.
bool names_plugin_file(std::string_view name);

/// The folders of UNDERSTUDY_PLUGINS, separated by colons, and the folder of this installation.
std::vector<std::filesystem::path> plugin_folders();

/// NAME.so in the first of plugin_folders() that has it.
std::optional<std::filesystem::path> find_plugin(std::string_view name);

/// All *.so in plugin_folders(), by name.
std::vector<std::filesystem::path> plugin_files();

/// Loads the library, which stays loaded. Throws std::runtime_error with the reason if it is not a unit for
/// this version.
UnitDescription load_plugin(const std::filesystem::path& file);

}  // namespace understudy::spu
