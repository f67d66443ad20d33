// The picture that a viewer's --describe tells of, drawn once more: in double precision, without OpenGL,
// knowing nothing but the description and the volume file.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace viewer_test {

/// RGB, channel values 0 to 255 before rounding, top row first. Without frame and axes: they are not described.
std::vector<double> emulate(const nlohmann::json& description);

}  // namespace viewer_test
