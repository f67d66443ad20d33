// SPDX-License-Identifier: Apache-2.0
// A volume in a file and the image that is wanted of it, as commands without an application take them on
// their command lines.
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
  std::vector<std::string> volumes;  ///< of one time step each, or of several
  int time_step = 0;                 ///< of all of them, counted from 0
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
  bool samples_are_free = false;  ///< a budget says where they lie
};

void add_scene_options(CLI::App& subcommand, SceneArguments& arguments);

/// What an image of a volume shows, from where, and how finely.
struct ImageSettings {
  volume::TransferControlPoints control_points;
  Shading shading;
  volume::OrbitCamera camera;
  int width = 512;
  int height = 512;
  double step = 1;  ///< between samples, in voxels of the finest level
  float termination = 5e-6F;
  bool bounds_error = false;  ///< requests are made for certified bounds, too
};

struct FileScene {
  compositor::LoadRequest load;            ///< of the time step that is shown first
  std::vector<volume::SeriesStep> series;  ///< all time steps
  int time_step = 0;                       ///< that of `load`
  volume::FileDescription file;
  volume::TexelMapping mapping;
  ImageSettings image;

  /// Of the texture that its scalars become, in the unit of their spacing.
  volume::Vec3 extent() const;
  /// Of the volume itself, where `file` is a coarser level of it.
  std::array<int, 3> volume_size() const { return file.detail ? file.detail->volume_size : file.size; }
  /// Between the volume's own scalars.
  volume::Vec3 voxel() const;
  /// Of any time step, as a volume beside the others.
  compositor::LoadRequest load_of(int step) const;
};

/// Everything that can be known to be wrong before a byte of the volume is read. The volume's ghost layer is
/// wide enough for the image. Throws std::invalid_argument and volume::FileError.
FileScene scene_of(const SceneArguments& arguments);
/// The same of scalars that lie in no file: what `arguments` says of a file is not looked at.
FileScene scene_of(const SceneArguments& arguments, const volume::FileDescription& described);

/// All but the classification, and the surfaces' values. Throws std::invalid_argument.
volume::RenderRequest unclassified_request(const FileScene& scene, const ImageSettings& image);

/// Once it is known which values the volume has. Throws std::invalid_argument.
volume::RenderRequest request_of(const FileScene& scene, const ImageSettings& image,
                                 const volume::TexelFigures& values);

/// The values in the volume and how they became texels, summed over the ranks.
volume::TexelFigures texel_figures(const std::vector<compositor::RankLoad>& ranks);

}  // namespace understudy::launcher
