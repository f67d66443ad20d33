// SPDX-License-Identifier: Apache-2.0
// Transfer functions in files:
//   {"positions": "range", "knots": [{"at": 0.2, "colour": [1, 0.5, 0.2], "opacity": 0}, ...]}
// "positions" is "range" (the default: 0 is the volume's minimum, 1 its maximum) or "values"; opacity is that
// of one voxel's length.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "volume/transfer_control_points.h"

namespace understudy::launcher {

/// Parses control points in the form of such a file. Throws std::exception with what is wrong.
volume::TransferControlPoints control_points_in(const nlohmann::json& json);

/// Reads the file of this name if it exists; otherwise returns the built-in transfer function of this name.
/// Throws std::runtime_error or std::invalid_argument with the file, what is wrong and what to do.
volume::TransferControlPoints read_control_points(const std::string& file_or_name);

}  // namespace understudy::launcher
