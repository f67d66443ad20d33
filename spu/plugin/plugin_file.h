// SPDX-License-Identifier: Apache-2.0
// Units in shared libraries (unit_plugin.h): where they are looked for, and how they are loaded.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "spu/unit_description.h"

namespace understudy::spu {

/// Whether a chain names a file, and not a unit: there is a slash in it.
bool names_plugin_file(std::string_view name);

/// The folders of UNDERSTUDY_PLUGINS, which a colon divides, and that of this installation.
std::vector<std::filesystem::path> plugin_folders();

/// NAME.so in the first of plugin_folders() that has it.
std::optional<std::filesystem::path> find_plugin(std::string_view name);

/// All *.so in plugin_folders(), by name.
std::vector<std::filesystem::path> plugin_files();

/// Loads the library, which stays loaded. Throws std::runtime_error that says why it is no unit of this
/// version.
UnitDescription load_plugin(const std::filesystem::path& file);

}  // namespace understudy::spu
