// SPDX-License-Identifier: Apache-2.0
// What connections over TCP have done for a run: a file for each in the run's folder, written when it ends.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "compositor/transport/tcp/tcp_connection.h"

namespace understudy::launcher {

/// Into `folder`, under a name of this process's own. Nothing happens where that cannot be.
void write_connection_figures(const std::filesystem::path& folder, const std::string& address,
                              const compositor::TcpConnection& connection);

/// The sum of all connections in `folder`, as report_key::connection has it; null where there was none.
nlohmann::ordered_json connection_figures(const std::filesystem::path& folder);

/// In one line.
std::string connection_text(const nlohmann::ordered_json& figures);

}  // namespace understudy::launcher
