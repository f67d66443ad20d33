// SPDX-License-Identifier: Apache-2.0
// Entries of the desktop's menu (freedesktop.org, Desktop Entry Specification 1.5): those of viewers, and the
// same with Understudy under the viewer.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace understudy::launcher {

/// Where entries are, the user's own first: applications/ in $XDG_DATA_HOME (~/.local/share) and in each of
/// $XDG_DATA_DIRS (/usr/local/share:/usr/share).
std::vector<std::filesystem::path> application_folders();

/// The entry of a viewer: a path, or a name such as "paraview" for paraview.desktop or
/// org.paraview.ParaView.desktop.
std::optional<std::filesystem::path> find_desktop_entry(const std::string& viewer);

/// The entry's text with its programs run by `understudy run OPTION… --`, and " (Understudy)" behind its name.
/// It opens no kinds of files by default, is started by its command alone, and needs no service on the bus.
/// Throws std::runtime_error for what is no entry of an application.
std::string under_understudy(const std::string& entry, const std::filesystem::path& understudy,
                             const std::vector<std::string>& options);

}  // namespace understudy::launcher
