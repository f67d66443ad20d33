// SPDX-License-Identifier: Apache-2.0
// A volume in a file and the image to render of it, as specified on the command lines of
// commands without an application.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/understudy/file_scene/file_hints.h"
#include "apps/understudy/file_scene/shading_options.h"
#include "compositor/service/loading_service.h"
#include "volume/file/series.h"
#include "volume/file/texel_stream.h"
#include "volume/file/volume_file.h"
#include "volume/orbit_camera.h"
#include "volume/request.h"
#include "volume/transfer_control_points.h"

namespace understudy::launcher {

struct SceneArguments {
  std::vector<std::string> volumes;  ///< files of one time step each, or of several
  int time_step = 0;                 ///< index over all files, counted from 0
  ShadingArguments shading;
  std::string transfer_function = "grey";
  std::string camera = "30,20,4";
  std::string size = "512x512";
  double step = 1;
  double termination = 5e-6;
  FileHintOptions raw;
  std::vector<double> spacing;
  std::string texels;
  std::string range;
  int level = 0;
  bool error_bound = false;
  bool samples_are_free = false;  ///< an error or time budget chooses the samples
};

void add_scene_options(CLI::App& subcommand, SceneArguments& arguments);

/// What an image of a volume shows, from which camera, and with which step.
struct ImageSettings {
  volume::TransferControlPoints control_points;
  Shading shading;
  volume::OrbitCamera camera;
  int width = 512;
  int height = 512;
  double step = 1;  ///< distance between samples, in voxels of the finest level
  float termination = 5e-6F;
  bool bounds_error = false;  ///< certified error bounds are requested, too
};

struct FileScene {
  compositor::LoadRequest load;            ///< for the time step that is shown first
  std::vector<volume::SeriesStep> series;  ///< all time steps
  int time_step = 0;                       ///< the time step of `load`
  volume::FileDescription file;
  volume::TexelMapping mapping;
  ImageSettings image;

  /// Extent of the texture that the scalars become, in the unit of their spacing.
  volume::Vec3 extent() const;
  /// Size of the volume itself, even if `file` is a coarser level of it.
  std::array<int, 3> volume_size() const { return file.detail ? file.detail->volume_size : file.size; }
  /// Spacing of the volume's own scalars.
  volume::Vec3 voxel() const;
  /// Request to load any time step, as a volume separate from the others.
  compositor::LoadRequest load_of(int step) const;
};

/// Makes the scene; detects every error that can be detected before the volume is read. The ghost layer is wide
/// enough for the image. Throws std::invalid_argument and volume::FileError.
FileScene scene_of(const SceneArguments& arguments);
/// The same for scalars that are not in a file: arguments that concern a file are ignored.
FileScene scene_of(const SceneArguments& arguments, const volume::FileDescription& described);

/// Makes a request without the classification and the values of the surfaces. Throws std::invalid_argument.
volume::RenderRequest unclassified_request(const FileScene& scene, const ImageSettings& image);

/// Completes the request once the range of the volume's values is known. Throws std::invalid_argument.
volume::RenderRequest request_of(const FileScene& scene, const ImageSettings& image,
                                 const volume::TexelFigures& values);

/// Returns the range of the volume's values and the conversion errors, combined over the ranks.
volume::TexelFigures texel_figures(const std::vector<compositor::RankLoad>& ranks);

}  // namespace understudy::launcher
