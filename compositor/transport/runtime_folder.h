// SPDX-License-Identifier: Apache-2.0
// The folder for sockets and for private folders of runs.
#pragma once

#include <filesystem>
#include <optional>

namespace understudy::compositor {

/// Whether `folder` belongs to this user and nobody else may write into it.
bool is_private_folder(const std::filesystem::path& folder);

/// Returns $XDG_RUNTIME_DIR if it is private and writable: names in it may be predictable.
std::optional<std::filesystem::path> private_runtime_folder();

/// The same, or else /tmp, where only names that nobody can guess are safe.
std::filesystem::path runtime_folder();

}  // namespace understudy::compositor
