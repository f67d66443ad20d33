// SPDX-License-Identifier: Apache-2.0
// Entries of the desktop menu (freedesktop.org, Desktop Entry Specification 1.5): those of viewers, and copies
// that start the viewer under Understudy.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace understudy::launcher {

/// Returns the folders of entries, the user's own first: applications/ in $XDG_DATA_HOME (~/.local/share) and
/// in each of $XDG_DATA_DIRS (/usr/local/share:/usr/share).
std::vector<std::filesystem::path> application_folders();

/// Finds the entry of a viewer, given as a path or as a name such as "paraview" for paraview.desktop or
/// org.paraview.ParaView.desktop.
std::optional<std::filesystem::path> find_desktop_entry(const std::string& viewer);

/// Returns the entry's text with its programs run by `understudy run OPTION… --`, and " (Understudy)" after its
/// name. The new entry is not registered for file types, and starts by its command only, without a D-Bus
/// service. Throws std::runtime_error if the text is not an application's entry.
std::string under_understudy(const std::string& entry, const std::filesystem::path& understudy,
                             const std::vector<std::string>& options);

}  // namespace understudy::launcher
