// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/shading_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "apps/understudy/file_scene/number_list.h"
#include "volume/brick/brick_store.h"
#include "volume/surface.h"

namespace understudy::launcher {
namespace {

constexpr volume::Rgba plain_surface{0.9F, 0.9F, 0.9F, 1};

/// Parses all of `text` as one number.
std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Parses a colour such as "#e8c090"; the '#' is optional.
std::optional<std::array<float, 3>> colour_in(std::string_view text) {
  if (text.starts_with('#')) text.remove_prefix(1);
  unsigned bits = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), bits, 16);
  if (text.size() != 6 || error != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return std::array{float(bits >> 16U & 255U) / 255, float(bits >> 8U & 255U) / 255, float(bits & 255U) / 255};
}

SurfaceChoice surface_in(const std::string& text) {
  const auto fail = [&](const char* what) {
    throw std::invalid_argument(
        fmt::format("--surface {}: {}; give a value of the volume or a percentage of its range, optionally "
                    "followed by colour and opacity: 1150 or 40%,#e8c090,0.5",
                    text, what));
  };
  std::vector<std::string_view> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    parts.push_back(std::string_view(text).substr(at, end - at));
    at = end + 1;
  }
  if (parts.size() > 3) fail("there are more than three parts");
  SurfaceChoice surface{0, parts[0].ends_with('%'), plain_surface};
  if (surface.of_range) parts[0].remove_suffix(1);
  const auto at = number_in(parts[0]);
  if (!at) fail("the value is not a number");
  surface.at = surface.of_range ? *at / 100 : *at;
  if (surface.of_range && !(surface.at > 0 && surface.at <= 1))
    fail("the percentage must be above 0% and at most 100%");
  if (parts.size() > 1) {
    const auto colour = colour_in(parts[1]);
    if (!colour) fail("the colour does not have the form #rrggbb");
    std::ranges::copy(*colour, surface.colour.begin());
  }
  if (parts.size() > 2) {
    const auto opacity = number_in(parts[2]);
    if (!opacity || !(*opacity > 0 && *opacity <= 1)) fail("the opacity must be above 0 and at most 1");
    surface.colour[3] = float(*opacity);
  }
  return surface;
}

volume::Light light_of(const ShadingArguments& arguments, const volume::Vec3& extent) {
  volume::Light light;
  for (std::size_t k = 0; k < 3; ++k) light.space[4 * k] = extent[k];
  light.on_samples = arguments.light != "surfaces";
  if (!arguments.light_from.empty()) {
    const std::vector<double> angles = numbers(arguments.light_from, ',', 2, "45,60");
    if (!(std::isfinite(angles[0]) && std::abs(angles[1]) <= 90))
      throw std::invalid_argument(fmt::format(
          "--light-from {}: give two angles in degrees, the second from -90 to 90", arguments.light_from));
    const double azimuth = angles[0] * std::numbers::pi / 180, elevation = angles[1] * std::numbers::pi / 180;
    light.direction = {std::cos(elevation) * std::sin(azimuth), -std::cos(elevation) * std::cos(azimuth),
                       std::sin(elevation)};
  }
  if (!arguments.material.empty()) {
    const std::vector<double> parts = numbers(arguments.material, ',', 4, "0.2,0.8,0.3,20");
    if (!std::ranges::all_of(parts, [](double v) { return v >= 0 && v <= 1e4; }))
      throw std::invalid_argument(
          fmt::format("--material {}: give numbers from 0 to 10000", arguments.material));
    light.ambient.fill(float(parts[0]));
    light.diffuse.fill(float(parts[1]));
    light.specular.fill(float(parts[2]));
    light.shininess = float(parts[3]);
  }
  return light;
}

}  // namespace

void add_shading_options(CLI::App& subcommand, ShadingArguments& arguments) {
  subcommand
      .add_option("--method", arguments.method,
                  "classification along a ray: of each sample (post-classified), of the segment between two "
                  "samples (pre-integrated; needs fewer samples), or of samples whose distance adapts to the "
                  "transfer function (adaptive)")
      ->check(CLI::IsMember({"post-classified", "pre-integrated", "adaptive"}).description(""))
      ->type_name("post-classified|pre-integrated|adaptive")
      ->capture_default_str();
  subcommand
      .add_option("--cut-at-bricks", arguments.cut_at_bricks,
                  "with --method pre-integrated: end segments at the faces of bricks of EDGE voxels (a "
                  "multiple of 8), for comparison with renderers whose bricks share only their faces")
      ->type_name("EDGE");
  subcommand
      .add_option("--tolerance", arguments.tolerance, "with --method adaptive: largest error of each step")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("ERROR")
      ->capture_default_str();
  subcommand
      .add_option("--operator", arguments.op,
                  "combination of the samples of a ray: composited front to back (over), their maximum (max), "
                  "their sum (add), or the first sample that is not transparent, shown opaque (first-hit)")
      ->check(CLI::IsMember({"over", "max", "add", "first-hit"}).description(""))
      ->type_name("over|max|add|first-hit")
      ->capture_default_str();
  subcommand
      .add_option("--surface", arguments.surfaces,
                  "iso-surface at a value, or at a percentage of the volume's range of values (40%), "
                  "optionally with a colour #rrggbb and an opacity; may be given several times")
      ->type_name("VALUE[,COLOUR[,OPACITY]]")
      ->allow_extra_args(false);
  subcommand.add_flag("--no-volume", arguments.no_volume, "show only iso-surfaces, not the volume itself");
  subcommand
      .add_option("--light", arguments.light,
                  "apply Blinn-Phong lighting to the volume and its iso-surfaces (all), or to iso-surfaces "
                  "only (surfaces); the light is at the eye unless --light-from is given")
      ->check(CLI::IsMember({"all", "surfaces"}).description(""))
      ->type_name("all|surfaces");
  subcommand
      .add_option("--light-from", arguments.light_from,
                  "direction of a fixed light: azimuth and elevation in degrees, as for --camera")
      ->type_name("A,E");
  subcommand
      .add_option(
          "--material", arguments.material,
          "ambient, diffuse and specular reflection, and shininess, under --light (default 0.2,0.8,0.3,20)")
      ->type_name("A,D,S,N");
}

namespace {

volume::Method method_of(const ShadingArguments& arguments) {
  if (arguments.method == "pre-integrated") return volume::Method::pre_integrated;
  if (arguments.method == "adaptive") return volume::Method::adaptive;
  return volume::Method::post_classified;
}

volume::Operator operator_of(const ShadingArguments& arguments) {
  if (arguments.op == "max") return volume::Operator::max;
  if (arguments.op == "add") return volume::Operator::add;
  if (arguments.op == "first-hit") return volume::Operator::first_hit;
  return volume::Operator::over;
}

/// Returns the edge in blocks. Throws std::invalid_argument.
std::uint8_t cut_of(const ShadingArguments& arguments, volume::Method method) {
  constexpr int block = volume::BrickStore::block_cells;
  if (arguments.cut_at_bricks < 0 || arguments.cut_at_bricks % block != 0 ||
      arguments.cut_at_bricks / block > 255)
    throw std::invalid_argument(fmt::format("--cut-at-bricks {}: give a multiple of {}, up to {}",
                                            arguments.cut_at_bricks, block, 255 * block));
  if (arguments.cut_at_bricks != 0 && method != volume::Method::pre_integrated)
    throw std::invalid_argument("--cut-at-bricks requires --method pre-integrated");
  return std::uint8_t(arguments.cut_at_bricks / block);
}

/// Throws std::invalid_argument if the operator or the method cannot be combined with surfaces or light.
void check_combination(const ShadingArguments& arguments, volume::Method method) {
  const bool plain = arguments.surfaces.empty() && arguments.light.empty() && arguments.light_from.empty();
  if (arguments.op != "over" && !(plain && method == volume::Method::post_classified))
    throw std::invalid_argument(fmt::format(
        "--operator {} requires post-classified samples without surfaces or light; leave out --method, "
        "--surface and --light",
        arguments.op));
  if (method == volume::Method::adaptive && !plain)
    throw std::invalid_argument(
        "--method adaptive supports neither surfaces nor light; give --method pre-integrated, or leave them "
        "out");
}

}  // namespace

Shading shading_of(const ShadingArguments& arguments, const volume::Vec3& extent) {
  Shading shading;
  shading.method = method_of(arguments);
  shading.tolerance = arguments.tolerance;
  shading.cut_at_bricks = cut_of(arguments, shading.method);
  shading.op = operator_of(arguments);
  check_combination(arguments, shading.method);
  shading.shows_volume = !arguments.no_volume;
  if (arguments.surfaces.size() > volume::max_surfaces)
    throw std::invalid_argument(fmt::format("{} surfaces are too many; give at most {}",
                                            arguments.surfaces.size(), volume::max_surfaces));
  for (const std::string& text : arguments.surfaces) shading.surfaces.push_back(surface_in(text));
  if (!shading.shows_volume && shading.surfaces.empty())
    throw std::invalid_argument("--no-volume shows nothing without a surface; give a --surface as well");
  if (arguments.light == "surfaces" && shading.surfaces.empty())
    throw std::invalid_argument(
        "--light surfaces has no effect without a surface; give a --surface as well, or --light all");
  if (!arguments.light.empty() || !arguments.light_from.empty())
    shading.light = light_of(arguments, extent);
  else if (!arguments.material.empty())
    throw std::invalid_argument("--material has no effect without a light; give --light all as well");
  return shading;
}

std::vector<double> surface_values(const Shading& shading, double low, double high) {
  std::vector<double> values;
  for (const SurfaceChoice& surface : shading.surfaces) {
    values.push_back(surface.of_range ? low + surface.at * (high - low) : surface.at);
    if (!(values.back() > low && values.back() <= high))
      throw std::invalid_argument(
          fmt::format("a surface at {:g} shows nothing: the volume's values range from {:g} to {:g}; give a "
                      "value in this range, above its lower end, or a percentage of it, as in 40%",
                      values.back(), low, high));
  }
  return values;
}

}  // namespace understudy::launcher
