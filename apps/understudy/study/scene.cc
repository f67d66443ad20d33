// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/study/scene.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "volume/error_bound/error_bound.h"
#include "volume/file/synthetic.h"
#include "volume/file/texel_stream.h"
#include "volume/matrix.h"
#include "volume/opacity_correction.h"
#include "volume/opening/open_volume.h"
#include "volume/raycast/pre_integration_lookup.h"
#include "volume/raycast/segment_scene.h"
#include "volume/reference/pixel_integral.h"

namespace understudy::launcher::study {
namespace {

using volume::Rgba;
using volume::TransferFunction;

constexpr std::size_t slice_range_bytes = std::size_t(16) << 20;
/// Entries of the transfer function, as many as in most viewers.
constexpr std::size_t table_entries = 256;
/// Limits of the entries of transfer functions for other steps than one voxel: all represent the same
/// medium, whose opacity is linear between the entries for one voxel. The size of a pre-integration table is
/// the square of its entries.
constexpr std::size_t most_entries = 4096, most_entries_of_segments = volume::max_pre_integration_edge;

/// Samples `table` at 256 values. Between them it is considered linear, also by the reference.
TransferFunction resampled(const TransferFunction& table) {
  TransferFunction result{table.low, table.high, {}};
  const auto last = double(table.entries.size() - 1);
  for (std::size_t i = 0; i < table_entries; ++i) {
    const double at = last * double(i) / double(table_entries - 1);
    const auto below = std::min(std::size_t(at), table.entries.size() - 2);
    const auto share = float(at - double(below));
    Rgba& entry = result.entries.emplace_back();
    for (std::size_t k = 0; k < 4; ++k)
      entry[k] = (1 - share) * table.entries[below][k] + share * table.entries[below + 1][k];
  }
  return result;
}

std::array<double, 4> sample_of(const TransferFunction& table, double value) {
  const double share = std::clamp((value - double(table.low)) / double(table.high - table.low), 0.0, 1.0);
  return entry_at(table, share * double(table.entries.size() - 1));
}

/// Returns the greatest optical depth of one voxel.
double greatest_depth(const TransferFunction& table) {
  double opacity = 0;
  for (const Rgba& entry : table.entries) opacity = std::max(opacity, double(entry[3]));
  return -std::log1p(-opacity);
}

double in_bytes(double value) {
  return std::round(255 * std::clamp(value, 0.0, 1.0)) / 255;
}

}  // namespace

std::vector<SceneDescription> built_in_scenes() {
  const auto range = [](std::vector<volume::TransferControlPoints::ControlPoint> control_points) {
    return volume::TransferControlPoints{false, std::move(control_points)};
  };
  return {
      {"smooth", "a smooth field under a smooth table: the order of accuracy shows",
       "synthetic:96x96x96:f32:gyroid",
       range({{0, {0.1, 0.2, 0.8}, 0}, {0.5, {0.3, 0.8, 0.4}, 0.02}, {1, {1, 0.6, 0.2}, 0.08}})},
      {"opaque-layers", "stiff: thin layers of opacity 0.9999 in a table with steps",
       "synthetic:96x96x96:f32:gyroid",
       range({{0, {0.9, 0.4, 0.1}, 0},
              {0.62, {0.9, 0.4, 0.1}, 0},
              {0.62, {0.9, 0.4, 0.1}, 0.9999},
              {0.66, {0.9, 0.8, 0.3}, 0.9999},
              {0.66, {0.9, 0.8, 0.3}, 0},
              {1, {0.9, 0.8, 0.3}, 0}})},
      {"thin-fog", "opacities below half a byte a sample: eight bits lose them", "synthetic:96x96x96:u8:lobes",
       range({{0, {0.7, 0.8, 0.9}, 0.0002}, {1, {1, 1, 1}, 0.0018}})},
      {"spikes", "a table narrower than the field's change over a step", "synthetic:96x96x96:u16:lobes",
       range({{0, {0.2, 0.3, 1}, 0},
              {0.30, {0.2, 0.3, 1}, 0},
              {0.305, {0.2, 0.5, 1}, 0.4},
              {0.31, {0.2, 0.5, 1}, 0},
              {0.60, {1, 0.4, 0.2}, 0},
              {0.605, {1, 0.4, 0.2}, 0.6},
              {0.61, {1, 0.4, 0.2}, 0},
              {1, {1, 1, 1}, 0}})},
      {"anisotropic",
       "voxels sixteen times as deep as wide",
       "synthetic:96x96x24:u8:shells",
       range({{0, {0.2, 0.6, 0.9}, 0}, {0.3, {0.2, 0.6, 0.9}, 0.01}, {1, {1, 0.9, 0.6}, 0.05}}),
       {1, 1, 16}},
  };
}

Scene::Scene(const SceneDescription& description, int edge, int stride)
    : edge_(edge - edge % stride), stride_(stride) {
  const std::string path = volume::is_synthetic(description.volume)
                               ? description.volume
                               : std::filesystem::absolute(description.volume).string();
  auto file = volume::open_volume(path);
  const volume::FileDescription read = file->description();
  const volume::TexelMapping mapping = mapping_of(read, {});
  description_.id = 1;
  description_.size = read.size;
  description_.type = mapping.type;
  description_.stored = {{0, 0, 0}, read.size};
  spacing_ = description.spacing == volume::Vec3{} ? read.spacing : description.spacing;
  for (double& distance : spacing_) distance = volume::believable_spacing(distance);

  volume::TexelStream stream(std::move(file), {}, description_.stored);
  while (!stream.done()) {
    const volume::TexelStream::SliceSegment slice_range = stream.next(slice_range_bytes);
    texels_.insert(texels_.end(), slice_range.texels.begin(), slice_range.texels.end());
  }
  const volume::TexelFigures& values = stream.figures();
  const double low = values.low <= values.high ? values.low : 0;
  const double high = values.low < values.high ? values.high : low + 1;
  value_range_ = {mapping.normalised(low), mapping.normalised(high)};
  std::ranges::sort(value_range_);
  table_ = resampled(sampled(spanning(description.control_points, low, high), low, high, 1));
  table_.low = float(mapping.normalised(double(table_.low)));
  table_.high = float(mapping.normalised(double(table_.high)));
  if (table_.low > table_.high) {  // texels decrease with increasing values
    std::swap(table_.low, table_.high);
    std::ranges::reverse(table_.entries);
  }

  volume::RenderRequest bounding = request(8, volume::Method::post_classified, 0, cameras().front());
  bounding.bound_of.emplace();
  description_.ghost_layer = std::max(
      ghost_layer_needed(description_, bounding),
      ghost_layer_needed(description_, request(8, volume::Method::pre_integrated, 0, cameras().front())));
  store_ = std::make_unique<volume::BrickStore>(description_, volume::cell_lattice(description_).box());
  store_->add_slices(description_.stored, texels_);
  store_->finish();
  variation_.emplace(*store_);
  field_ = texture_field(description_, volume::Filter::linear, texels_);
}

std::span<const volume::OrbitCamera> Scene::cameras() {
  static constexpr std::array<volume::OrbitCamera, 5> fixed{
      {{35, 25, 3}, {-70, 8, 2.4}, {150, 60, 3.5}, {215, -35, 2}, {0, 0, 4}}};
  return fixed;
}

volume::RenderRequest Scene::request(double step, volume::Method method, double termination,
                                     const volume::OrbitCamera& camera) const {
  volume::RenderRequest request = orbit_request(description_, spacing_, camera, edge_, edge_, step);
  request.classification = opacity_corrected(
      table_, step, method == volume::Method::pre_integrated ? most_entries_of_segments : most_entries);
  request.method = method;
  request.termination = float(termination);
  request.steps->cover_whole_ray = may_cover_whole_rays(request);
  return request;
}

const char* Scene::texel_type() const {
  return description_.type == volume::TexelType::u8    ? "u8"
         : description_.type == volume::TexelType::u16 ? "u16"
                                                       : "f32";
}

void Scene::hand_out(const std::filesystem::path& texels, const std::filesystem::path& description) const {
  std::ofstream raw(texels, std::ios::binary);
  raw.write(reinterpret_cast<const char*>(texels_.data()), std::streamsize(texels_.size()));
  raw.close();

  // All programs take bytes as 0 to 255. Other types are stretched by most programs from
  // their actual range to 0 to 1.
  const bool bytes = description_.type == volume::TexelType::u8;
  const double low = bytes ? 0 : value_range_[0], high = bytes ? 1 : value_range_[1];
  const double unit = bytes ? 255 : description_.type == volume::TexelType::u16 ? 65535 : 1;
  std::vector<std::array<double, 4>> plain;
  for (std::size_t i = 0; i < table_entries; ++i) {
    std::array<double, 4>& entry =
        plain.emplace_back(sample_of(table_, low + (high - low) * double(i) / double(table_entries - 1)));
    for (std::size_t k = 0; k < 3 && entry[3] > 0; ++k) entry[k] = std::min(entry[k] / entry[3], 1.0);
  }
  // Extends colours into transparent entries, so that interpolation produces no dark rim.
  for (std::size_t i = 1; i < plain.size(); ++i)
    if (plain[i][3] <= 0) std::copy_n(plain[i - 1].begin(), 3, plain[i].begin());
  for (std::size_t i = plain.size() - 1; i-- > 0;)
    if (plain[i][3] <= 0 && (i == 0 || plain[i - 1][3] <= 0))
      std::copy_n(plain[i + 1].begin(), 3, plain[i].begin());
  nlohmann::json control_points = nlohmann::json::array();
  for (std::size_t i = 0; i < plain.size(); ++i)
    control_points.push_back({{"at", double(i) / double(table_entries - 1)},
                              {"colour", {plain[i][0], plain[i][1], plain[i][2]}},
                              {"opacity", plain[i][3]}});

  volume::Vec3 extent{};
  for (std::size_t k = 0; k < 3; ++k) extent[k] = description_.size[k] * spacing_[k];
  const double radius = volume::length(extent) / 2, finest = *std::ranges::min_element(spacing_);
  const volume::OrbitCamera& camera = cameras().front();
  const volume::Vec3 centre = volume::scale(extent, 0.5), back = eye_direction(camera);
  const nlohmann::json json{{"volume", std::filesystem::absolute(texels).string()},
                            {"size", description_.size},
                            {"type", texel_type()},
                            {"spacing", spacing_},
                            {"value_at_0", low * unit},
                            {"value_at_1", high * unit},
                            {"knots", control_points},
                            {"unit_distance", finest},
                            {"sample_distance", finest},
                            {"eye", volume::add(centre, volume::scale(back, camera.distance * radius))},
                            {"centre", centre},
                            {"up", {0, 0, 1}},
                            {"angle", volume::orbit_field_of_view},
                            {"near", (camera.distance - 1.01) * radius},
                            {"far", (camera.distance + 1.01) * radius},
                            {"pixels", edge_}};
  std::ofstream file(description);
  file << json.dump();
  file.close();
  if (!raw || !file)
    throw std::runtime_error(texels.string() + " or " + description.string() +
                             ": cannot be written; check that the disk is not full");
}

void Scene::integrate(const std::function<void(double done)>& progress) {
  const auto start = std::chrono::steady_clock::now();
  const int across = rays_across();
  const int rows = across * int(cameras().size());
  exact_.assign(std::size_t(rows) * std::size_t(across), {});
  std::vector<volume::RenderRequest> one_voxel;
  for (const volume::OrbitCamera& camera : cameras())
    one_voxel.push_back(request(1, volume::Method::post_classified, 0, camera));
  const volume::Medium medium = volume::Medium::of_samples(table_, 1);
  std::vector<double> changes(std::size_t(rows), 0);
  std::atomic<int> rows_done = 0;
  tbb::parallel_for(0, rows, [&](int row) {
    const volume::RenderRequest& seen = one_voxel[std::size_t(row / across)];
    const int y = pixel(row % across);
    for (int column = 0; column < across; ++column) {
      const int x = pixel(column);
      exact_[std::size_t(row) * std::size_t(across) + std::size_t(column)] =
          pixel_integral(field_, description_.size, seen, medium, x, y);
      changes[std::size_t(row)] = std::max(changes[std::size_t(row)], greatest_change(seen, x, y));
    }
    progress(double(++rows_done) / rows);
  });
  stiffness_ = {greatest_depth(table_), *std::ranges::max_element(changes)};
  reference_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double Scene::greatest_change(const volume::RenderRequest& one_voxel, int x, int y) const {
  const auto ray = volume::pixel_ray(one_voxel, x, y);
  if (!ray) return 0;
  double greatest = 0;
  std::optional<double> before;
  const auto samples = int(std::floor(ray->length - one_voxel.steps->first)) + 1;
  for (int i = 0; i < samples; ++i) {
    const double share = (one_voxel.steps->first + i) / ray->length;
    const double opacity = sample_of(table_, field_(ray->at(share))[0])[3];
    if (before) greatest = std::max(greatest, std::abs(opacity - *before));
    before = opacity;
  }
  return greatest;
}

double Scene::greatest_bound(const volume::RenderRequest& request, double step) const {
  volume::RenderRequest bounding = request;
  bounding.bound_of = {table_, step};
  return double(std::ranges::max(error_bounds(*store_, *variation_, bounding, stride_)));
}

Scene::Rays Scene::compared(const volume::Image& image) const {
  Rays rays;
  for (int row = 0; row < rays_across(); ++row)
    for (int column = 0; column < rays_across(); ++column) {
      const float* const at = image.at(pixel(column), pixel(row));
      rays.push_back({double(at[0]), double(at[1]), double(at[2]), double(at[3])});
    }
  return rays;
}

Scene::Rays Scene::in_eight_bits(double step) const {
  std::vector<volume::RenderRequest> asked;
  for (const volume::OrbitCamera& camera : cameras())
    asked.push_back(request(step, volume::Method::post_classified, 0, camera));
  const TransferFunction table = opacity_corrected(table_, step, table_entries);
  const int across = rays_across();
  const int rows = across * int(cameras().size());
  Rays rays(std::size_t(rows) * std::size_t(across));
  tbb::parallel_for(0, rows, [&](int row) {
    const volume::RenderRequest& seen = asked[std::size_t(row / across)];
    for (int column = 0; column < across; ++column) {
      const auto ray = volume::pixel_ray(seen, pixel(column), pixel(row % across));
      if (!ray) continue;
      std::array<double, 4>& shown = rays[std::size_t(row) * std::size_t(across) + std::size_t(column)];
      for (int i = int(std::floor(ray->length - seen.steps->first)); i >= 0; --i) {
        const std::array<double, 4> sample =
            sample_of(table, field_(ray->at((seen.steps->first + i) / ray->length))[0]);
        for (std::size_t k = 0; k < 4; ++k) shown[k] = in_bytes(sample[k] + (1 - sample[3]) * shown[k]);
      }
    }
  });
  return rays;
}

}  // namespace understudy::launcher::study
