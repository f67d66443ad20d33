// SPDX-License-Identifier: Apache-2.0
// What a rendering of a file shows beside samples: pre-integrated segments, iso-surfaces and light.
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
  int cut_at_bricks = 0;  ///< voxels along an edge; 0: nothing is cut
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
  bool of_range = false;  ///< 0 is the volume's least value and 1 its greatest; otherwise `at` is a value
  volume::Rgba colour{};
};

struct Shading {
  volume::Method method = volume::Method::post_classified;
  std::uint8_t cut_at_bricks = 0;  ///< as the request has it
  float tolerance = 0;             ///< of adaptive steps
  volume::Operator op = volume::Operator::over;
  bool shows_volume = true;  ///< false: surfaces alone
  std::vector<SurfaceChoice> surfaces;
  std::optional<volume::Light> light;
};

/// `extent` is the volume's, in any unit of length. Throws std::invalid_argument: what is wrong, what to give.
Shading shading_of(const ShadingArguments& arguments, const volume::Vec3& extent);

/// As volume values, given the least and the greatest one. Throws std::invalid_argument where a surface lies
/// outside of them.
std::vector<double> surface_values(const Shading& shading, double low, double high);

}  // namespace understudy::launcher
