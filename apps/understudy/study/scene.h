// SPDX-License-Identifier: Apache-2.0
// What a study looks at: a volume, a table and a camera, with the double-precision integral of some of its
// rays.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/image.h"
#include "volume/orbit_camera.h"
#include "volume/raycast/ray_caster.h"
#include "volume/reference/slice_sum.h"
#include "volume/request.h"
#include "volume/transfer_control_points.h"

namespace understudy::launcher::study {

struct SceneDescription {
  std::string name;
  std::string shows;   ///< why it is looked at, in a few words
  std::string volume;  ///< a file, or "synthetic:..."
  volume::TransferControlPoints control_points;
  volume::Vec3 spacing{};  ///< zeros: the file's own
};

/// Scenes that need no file.
std::vector<SceneDescription> built_in_scenes();

class Scene {
 public:
  /// Every `stride`-th pixel across and up of an image of `edge`^2 pixels is compared. Reads the volume.
  /// Throws volume::FileError, std::invalid_argument.
  Scene(const SceneDescription& description, int edge, int stride);

  /// One sample every `step` voxels (of the smallest spacing) along each ray.
  volume::RenderRequest request(double step, volume::Method method, double termination) const;

  /// Integrates the rays that are compared; a hundredth after the other is told to `progress`.
  void integrate(const std::function<void(double done)>& progress);

  /// Rays that are compared: premultiplied colour and opacity, row by row from the bottom.
  using Rays = std::vector<std::array<double, 4>>;
  const Rays& exact() const { return exact_; }
  Rays compared(const volume::Image& image) const;
  /// The image of slices blended into eight bits a channel, back to front: what the viewer itself would show
  /// of the same samples.
  Rays in_eight_bits(double step) const;
  int rays_across() const { return edge_ / stride_; }
  /// Of the images, in pixels.
  int edge() const { return edge_; }

  /// The scene for other programs: its texels in `texels`, and in `description` what apps/bench/vtk_mappers.py
  /// and the bundled viewer's --table read. Throws std::runtime_error.
  void hand_out(const std::filesystem::path& texels, const std::filesystem::path& description) const;
  const char* texel_type() const;
  const volume::Vec3& spacing() const { return spacing_; }
  static const volume::OrbitCamera& camera();

  const volume::BrickStore& store() const { return *store_; }
  const std::array<int, 3>& size() const { return description_.size; }
  double reference_seconds() const { return reference_seconds_; }

 private:
  volume::TransferFunction table_for(double step) const;
  int pixel(int ray) const { return ray * stride_ + stride_ / 2; }

  int edge_;
  int stride_;
  volume::VolumeDescription description_;
  volume::Vec3 spacing_;
  std::vector<std::byte> texels_;
  std::array<double, 2> value_range_{0, 1};  ///< of the texels, normalised
  std::unique_ptr<volume::BrickStore> store_;
  volume::Field field_;
  volume::TransferFunction table_;  ///< for a step of one voxel
  Rays exact_;
  double reference_seconds_ = 0;
};

}  // namespace understudy::launcher::study
