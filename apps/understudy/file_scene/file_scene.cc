// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/file_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "apps/understudy/file_scene/control_points_file.h"
#include "apps/understudy/file_scene/number_list.h"
#include "apps/understudy/images/image.h"
#include "spu/volume/budget/budget.h"
#include "volume/file/file_error.h"
#include "volume/file/slices/dicom_headers.h"
#include "volume/file/synthetic.h"
#include "volume/hierarchy/level_request.h"
#include "volume/matrix.h"
#include "volume/opacity_correction.h"
#include "volume/opening/open_volume.h"
#include "volume/raycast/segment_scene.h"

namespace understudy::launcher {
namespace {

constexpr volume::VolumeId volume_id = 1;

volume::TexelChoice texels_of(const SceneArguments& arguments) {
  volume::TexelChoice choice;
  if (arguments.texels == "u8") choice.type = volume::TexelType::u8;
  if (arguments.texels == "u16") choice.type = volume::TexelType::u16;
  if (arguments.texels == "f32") choice.type = volume::TexelType::f32;
  if (!arguments.range.empty()) {
    const std::vector<double> range = numbers(arguments.range, ',', 2, "0,4095");
    choice.range = {range[0], range[1]};
  }
  return choice;
}

ImageSettings image_of(const SceneArguments& arguments) {
  ImageSettings image;
  image.control_points = read_control_points(arguments.transfer_function);
  const std::vector<double> camera = numbers(arguments.camera, ',', 3, "30,20,4", 1);
  image.camera = {camera[0], camera[1], camera[2], camera.size() > 3 ? camera[3] : 0};
  const std::vector<double> size = numbers(arguments.size, 'x', 2, "512x512");
  for (const double side : size)
    if (!(side >= 1 && side <= max_image_side))
      throw std::invalid_argument(
          fmt::format("'{}' is not the size of an image; each side must be 1 to {} pixels", arguments.size,
                      max_image_side));
  image.width = int(size[0]);
  image.height = int(size[1]);
  image.step = arguments.step;
  image.termination = float(arguments.termination);
  return image;
}

}  // namespace

void add_scene_options(CLI::App& subcommand, SceneArguments& arguments) {
  subcommand
      .add_option("VOLUME", arguments.volumes,
                  "volume file: raw (with size and type in its name: head_256x256x113_int16be.raw.gz), NRRD, "
                  "NIfTI, MetaImage, DICOM, TIFF, VTI or UVOL, a folder of DICOM or TIFF slices or of Zarr, or "
                  "synthetic:XxYxZ[:u8|u16|f32[:shells|lobes|gyroid]]; several files, a pattern ('step_*.vti') "
                  "or a file of several volumes are the time steps of a series")
      ->required();
  subcommand
      .add_option("--time-step", arguments.time_step,
                  "time step of a series to show (to show first, in `understudy view`), counted from 0")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  subcommand
      .add_option(
          "--transfer-function,--tf", arguments.transfer_function,
          "transfer function: a JSON file of control points, or one of " + volume::built_in_control_points())
      ->capture_default_str();
  add_shading_options(subcommand, arguments.shading);
  subcommand
      .add_option("--camera", arguments.camera,
                  "position of the camera: azimuth and elevation in degrees, distance in half diagonals of the "
                  "volume, and roll in degrees (180: z points down)")
      ->type_name("A,E,D[,R]")
      ->capture_default_str();
  subcommand.add_option("--size", arguments.size, "size of the image, in pixels")
      ->type_name("WxH")
      ->capture_default_str();
  subcommand.add_option("--step", arguments.step, "distance between samples along a ray, in voxels")
      ->capture_default_str();
  subcommand
      .add_option("--termination", arguments.termination,
                  "early ray termination: a ray ends where its remaining transparency is below this value")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  add_file_hints(subcommand, arguments.raw);
  subcommand
      .add_option("--spacing", arguments.spacing,
                  "distances between scalars along x, y and z, instead of those in the file")
      ->type_name("X Y Z")
      ->expected(3)
      ->check(CLI::PositiveNumber);
  subcommand.add_option("--texels", arguments.texels, "type of the texels that scalars are converted to")
      ->check(CLI::IsMember({"u8", "u16", "f32"}));
  subcommand.add_option("--range", arguments.range, "range of values that u8 and u16 texels represent")
      ->type_name("LOW,HIGH");
}

volume::Vec3 FileScene::extent() const {
  volume::Vec3 extent{};
  for (std::size_t k = 0; k < 3; ++k) extent[k] = file.size[k] * file.spacing[k];
  return extent;
}

volume::Vec3 FileScene::voxel() const {
  return volume::scale(file.spacing, file.detail ? 1 / double(1 << file.detail->level) : 1.0);
}

compositor::LoadRequest FileScene::load_of(int step) const {
  compositor::LoadRequest request = load;
  const volume::SeriesStep& wanted = series.at(std::size_t(step));
  request.file = wanted.file;
  request.hints.time_step = wanted.in_file.value_or(0);
  request.volume.id = volume_id + volume::VolumeId(step);
  return request;
}

namespace {

struct Series {
  std::vector<volume::SeriesStep> steps;
  volume::FileDescription description;  ///< of any step, with the range of values over all steps
};

void append_steps(std::vector<volume::SeriesStep>& steps, const std::string& file, int in_file) {
  if (in_file == 1) {
    steps.push_back({file, std::nullopt});
    return;
  }
  for (int step = 0; step < in_file; ++step) steps.push_back({file, step});
}

/// Describes a series of files, which must have the same size, type and spacing.
Series described_series(const std::vector<std::string>& files, const volume::FileHints& hints,
                        bool spacing_is_given) {
  Series series;
  volume::FileDescription& first = series.description;
  volume::DicomHeaders headers;  // read once, because files of a series share a folder
  for (const std::string& file : files) {
    const volume::FileDescription one = volume::open_volume(file, hints, {}, headers)->description();
    append_steps(series.steps, file, one.time_steps);
    if (series.steps.size() > volume::max_time_steps)
      throw volume::FileError(fmt::format("{}: with this file the series has {} time steps; the limit is {}",
                                          file, series.steps.size(), volume::max_time_steps));
    if (&file == &files.front()) {
      first = one;
      continue;
    }
    if (one.size != first.size || one.type != first.type)
      throw volume::FileError(
          fmt::format("{}: this time step has {} x {} x {} scalars of type {}, but {} has {} x {} x {} of type "
                      "{}; give time steps of the same size and type",
                      file, one.size[0], one.size[1], one.size[2], volume::name_of(one.type), files.front(),
                      first.size[0], first.size[1], first.size[2], volume::name_of(first.type)));
    if (one.spacing != first.spacing && !spacing_is_given)
      throw volume::FileError(
          fmt::format("{}: the spacing of its scalars differs from that of {}; give time steps with the same "
                      "spacing, or --spacing",
                      file, files.front()));
    if (one.detail && first.detail && one.detail->volume_size != first.detail->volume_size)
      throw volume::FileError(fmt::format(
          "{}: this level belongs to a volume of a different size than that of {}", file, files.front()));
    if (one.scale != first.scale || one.offset != first.offset)
      throw volume::FileError(
          fmt::format("{}: the scale or offset of its values differs from that of {}; give time steps with the "
                      "same scale and offset",
                      file, files.front()));
    if (first.detail && one.detail) first.detail->error = std::max(first.detail->error, one.detail->error);
    if (first.values && one.values)
      first.values = {std::min((*first.values)[0], (*one.values)[0]),
                      std::max((*first.values)[1], (*one.values)[1])};
    else
      first.values.reset();
  }
  return series;
}

}  // namespace

FileScene scene_of(const SceneArguments& arguments) {
  std::vector<std::string> files = volume::files_of_series(arguments.volumes);
  for (std::string& file : files)
    if (!volume::is_synthetic(file)) file = std::filesystem::absolute(file).string();
  volume::FileHints hints = file_hints(arguments.raw);
  hints.level = arguments.level;
  Series series = described_series(files, hints, !arguments.spacing.empty());
  if (std::size_t(arguments.time_step) >= series.steps.size())
    throw std::invalid_argument(fmt::format("there is no time step {}; the series has {}, counted from 0",
                                            arguments.time_step, series.steps.size()));
  FileScene scene = scene_of(arguments, series.description);
  scene.load.hints = hints;
  scene.series = std::move(series.steps);
  scene.time_step = arguments.time_step;
  scene.load = scene.load_of(scene.time_step);
  scene.load.volume.id = volume_id;
  return scene;
}

FileScene scene_of(const SceneArguments& arguments, const volume::FileDescription& described) {
  FileScene scene;
  scene.image = image_of(arguments);
  scene.load.texels = texels_of(arguments);
  scene.file = described;
  if (!arguments.spacing.empty()) std::ranges::copy(arguments.spacing, scene.file.spacing.begin());
  if (const auto& detail = described.detail) {
    if (arguments.error_bound)
      throw std::invalid_argument(
          "--error-bound does not include the error of a level of detail; leave out --level");
    const double apart = double(1 << detail->level);
    // --step is in samples of the level.
    scene.image.step *= apart;
    if (!arguments.spacing.empty()) scene.file.spacing = volume::scale(scene.file.spacing, apart);
  }
  for (double& distance : scene.file.spacing) distance = volume::believable_spacing(distance);
  scene.mapping = volume::mapping_of(scene.file, scene.load.texels);
  scene.load.volume.id = volume_id;
  scene.load.volume.size = scene.file.size;
  scene.load.volume.type = scene.mapping.type;
  scene.load.volume.stored = {{0, 0, 0}, scene.file.size};
  scene.image.shading = shading_of(arguments.shading, scene.extent());
  scene.image.bounds_error = arguments.error_bound;
  // Pre-integrated segments, gradients and error bounds need cells beyond a node's own,
  // but never beyond the volume.
  scene.load.volume.ghost_layer =
      volume::ghost_layer_needed(scene.load.volume, unclassified_request(scene, scene.image));
  if (arguments.samples_are_free)
    scene.load.volume.ghost_layer =
        std::max(scene.load.volume.ghost_layer,
                 std::min(spu::budget_ghost_layer, *std::ranges::min_element(scene.file.size)));
  if (scene.load.volume.ghost_layer > *std::ranges::max_element(scene.file.size))
    throw std::invalid_argument(
        fmt::format("a step of {} voxels is longer than the volume; give a smaller one", arguments.step));
  return scene;
}

volume::RenderRequest unclassified_request(const FileScene& scene, const ImageSettings& image) {
  volume::VolumeDescription volume = scene.load.volume;
  volume.size = scene.volume_size();
  volume::RenderRequest request =
      volume::orbit_request(volume, scene.voxel(), image.camera, image.width, image.height, image.step);
  if (scene.file.detail) volume::show_level(request, volume.size, scene.file.detail->level);
  request.termination = image.termination;
  const Shading& shading = image.shading;
  request.method = shading.method;
  request.tolerance = shading.tolerance;
  request.cut_at_bricks = shading.cut_at_bricks;
  request.op = shading.op;
  request.light = shading.light;
  if (image.bounds_error) request.bound_of.emplace();
  for (const SurfaceChoice& surface : shading.surfaces) request.surfaces.push_back({0, surface.colour});
  return request;
}

namespace {

std::invalid_argument no_bound() {
  return std::invalid_argument(
      "--error-bound requires post-classified samples that are composited front to back; leave out --method, "
      "--operator, --surface, --no-volume and --light");
}

}  // namespace

volume::RenderRequest request_of(const FileScene& scene, const ImageSettings& image,
                                 const volume::TexelFigures& values) {
  volume::RenderRequest request = unclassified_request(scene, image);
  // A level of detail, or scalars that were rounded, may lack the volume's extremes, which the
  // transfer function refers to.
  const auto [least, greatest] = scene.file.values.value_or(std::array{values.low, values.high});
  // A constant volume has no range: its value is mapped to the lower end of the transfer function.
  const double low = least <= greatest ? least : 0.0;
  const double high = least < greatest ? greatest : low + 1;
  const std::vector<double> surfaces = surface_values(image.shading, low, high);
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    request.surfaces[i].value = scene.mapping.normalised(surfaces[i]);
  if (request.light) {
    // A thousandth of the range of values, per voxel.
    const double range = std::abs(scene.mapping.normalised(high) - scene.mapping.normalised(low));
    request.light->full_slope = float(1e-3 * range / std::ranges::max(scene.voxel()));
  }
  if (!image.shading.shows_volume) {
    if (image.bounds_error) throw no_bound();
    request.classification = volume::TransferFunction{0, 1, {{}, {}}};
    return request;
  }
  const bool segments = request.method == volume::Method::pre_integrated;
  volume::TransferFunction table =
      sampled(segments ? spanning(image.control_points, low, high) : image.control_points, low, high, 1);
  double first = scene.mapping.normalised(table.low), last = scene.mapping.normalised(table.high);
  if (first > last) {  // texels decrease with increasing values
    std::swap(first, last);
    std::ranges::reverse(table.entries);
  }
  set_range(table, first, last);
  // The medium is the same at every step size: opacity is linear between entries for one voxel's length.
  request.classification = opacity_corrected(table, image.step, table.entries.size());
  if (image.bounds_error) request.bound_of = {std::move(table), image.step};
  request.steps->cover_whole_ray = may_cover_whole_rays(request);
  if (image.bounds_error && !request.steps->cover_whole_ray) throw no_bound();
  return request;
}

volume::TexelFigures texel_figures(const std::vector<compositor::RankLoad>& ranks) {
  volume::TexelFigures figures;
  for (const compositor::RankLoad& rank : ranks) {
    if (rank.low <= rank.high) {  // a rank may have no part of the volume
      const bool first = figures.low > figures.high;
      figures.low = first ? rank.low : std::min(figures.low, rank.low);
      figures.high = first ? rank.high : std::max(figures.high, rank.high);
    }
    figures.largest_error = std::max(figures.largest_error, rank.largest_error);
    figures.not_numbers += rank.not_numbers;
  }
  return figures;
}

}  // namespace understudy::launcher
