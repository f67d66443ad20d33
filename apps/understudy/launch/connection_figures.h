// SPDX-License-Identifier: Apache-2.0
// Figures of a run's TCP connections: each connection writes a file to the run's folder when it ends.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "compositor/transport/tcp/tcp_connection.h"

namespace understudy::launcher {

/// Writes the figures to a file in `folder` that is named after this process. Does nothing if that fails.
void write_connection_figures(const std::filesystem::path& folder, const std::string& address,
                              const compositor::TcpConnection& connection);

/// Returns the sum of all connections in `folder`, in the form of
/// report_key::connection; null if there was none.
nlohmann::ordered_json connection_figures(const std::filesystem::path& folder);

/// Returns the figures in one line.
std::string connection_text(const nlohmann::ordered_json& figures);

}  // namespace understudy::launcher
