// SPDX-License-Identifier: Apache-2.0
// The viewers of this user that run under Understudy, and what `understudy ctl` asks them.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "spu/control/control_message.h"

namespace understudy::launcher {

/// A viewer that has answered.
struct RunningViewer {
  pid_t process = 0;
  std::filesystem::path socket;
  nlohmann::ordered_json answer;  ///< to a status request

  /// The program's file name without its folder.
  std::string program() const;
};

/// Asks all viewers for their status. Removes the sockets of processes that are gone; a viewer that does not
/// answer is reported on stderr and left out. Throws std::runtime_error if the folder of the sockets is not
/// private.
std::vector<RunningViewer> running_viewers();

/// Returns the viewer with this process id or program name; without a name, the only one. Throws
/// std::runtime_error: none, or more than one, fits.
const RunningViewer& chosen_viewer(std::span<const RunningViewer> viewers, const std::string& name);

/// Returns the answer of the viewer at `socket`. Throws std::runtime_error: it does not answer, its answer is
/// malformed, or it refuses, with its reason.
nlohmann::ordered_json ask(const std::filesystem::path& socket, const spu::ControlRequest& request);

}  // namespace understudy::launcher
