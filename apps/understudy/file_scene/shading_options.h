// SPDX-License-Identifier: Apache-2.0
// Shading of a volume in a file: classification method, operator, iso-surfaces and light.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volume/blending_operator.h"
#include "volume/integration_method.h"
#include "volume/light.h"
#include "volume/rgba.h"
#include "volume/texture_space.h"

namespace understudy::launcher {

struct ShadingArguments {
  std::string method = "post-classified";
  int cut_at_bricks = 0;  ///< edge of the bricks, in voxels; 0: segments are not cut
  float tolerance = 1e-3F;
  std::string op = "over";
  std::vector<std::string> surfaces;
  bool no_volume = false;
  std::string light;
  std::string light_from;
  std::string material;
};

void add_shading_options(CLI::App& subcommand, ShadingArguments& arguments);

struct SurfaceChoice {
  double at = 0;
  bool of_range = false;  ///< `at` is 0 for the volume's minimum and 1 for its maximum; otherwise a value
  volume::Rgba colour{};
};

struct Shading {
  volume::Method method = volume::Method::post_classified;
  std::uint8_t cut_at_bricks = 0;  ///< in the form of the request
  float tolerance = 0;             ///< largest error of an adaptive step
  volume::Operator op = volume::Operator::over;
  bool shows_volume = true;  ///< false: only surfaces
  std::vector<SurfaceChoice> surfaces;
  std::optional<volume::Light> light;
};

/// `extent` is the volume's, in any unit of length. Throws std::invalid_argument with what
/// is wrong and what to give.
Shading shading_of(const ShadingArguments& arguments, const volume::Vec3& extent);

/// Returns the values of the surfaces, given the volume's minimum and maximum. Throws std::invalid_argument if
/// a surface is outside this range.
std::vector<double> surface_values(const Shading& shading, double low, double high);

}  // namespace understudy::launcher
