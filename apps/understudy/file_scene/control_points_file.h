// SPDX-License-Identifier: Apache-2.0
// Transfer functions in files:
//   {"positions": "range", "knots": [{"at": 0.2, "colour": [1, 0.5, 0.2], "opacity": 0}, ...]}
// "positions" is "range" (0 is the volume's least value, 1 its greatest; so without it) or "values"; opacity is
// that of one voxel's length.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "volume/transfer_control_points.h"

namespace understudy::launcher {

/// As such a file has them. Throws std::exception: what is wrong.
volume::TransferControlPoints control_points_in(const nlohmann::json& json);

/// A file, where there is one of this name, or a built-in table. Throws std::runtime_error and
/// std::invalid_argument: which file, what is wrong, what to do.
volume::TransferControlPoints read_control_points(const std::string& file_or_name);

}  // namespace understudy::launcher
