// SPDX-License-Identifier: Apache-2.0
// A scene of a study: a volume, a transfer function and several cameras, with the double-precision
// integral of some of their rays.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/error_bound/field_variation.h"
#include "volume/image.h"
#include "volume/orbit_camera.h"
#include "volume/raycast/ray_caster.h"
#include "volume/reference/slice_sum.h"
#include "volume/request.h"
#include "volume/transfer_control_points.h"

namespace understudy::launcher::study {

struct SceneDescription {
  std::string name;
  std::string shows;   ///< the purpose of the scene, in a few words
  std::string volume;  ///< a file, or "synthetic:..."
  volume::TransferControlPoints control_points;
  volume::Vec3 spacing{};  ///< zeros: that of the file
};

/// Returns the scenes that need no file.
std::vector<SceneDescription> built_in_scenes();

/// How stiff a scene is for samples one voxel apart.
struct Stiffness {
  double depth = 0;   ///< greatest optical depth of a voxel for any value of the volume
  double change = 0;  ///< greatest change of opacity between neighbouring samples of a compared ray

  bool operator==(const Stiffness&) const = default;
};

class Scene {
 public:
  /// Reads the volume. Every `stride`-th pixel in both directions of each camera's image of `edge`^2 pixels is
  /// compared. Throws volume::FileError and std::invalid_argument.
  Scene(const SceneDescription& description, int edge, int stride);

  /// Cameras in different directions and distances. Other programs show the first one.
  static std::span<const volume::OrbitCamera> cameras();
  /// Makes a request with one sample every `step` voxels (of the smallest spacing) along each ray of a camera.
  volume::RenderRequest request(double step, volume::Method method, double termination,
                                const volume::OrbitCamera& camera) const;

  /// Integrates the compared rays; calls `progress` with the fraction that is done.
  void integrate(const std::function<void(double done)>& progress);

  /// The compared rays: premultiplied colour and opacity, row by row from the bottom, camera by camera.
  using Rays = std::vector<std::array<double, 4>>;
  const Rays& exact() const { return exact_; }
  /// The compared rays of the first camera.
  std::span<const std::array<double, 4>> exact_of_first_camera() const {
    return std::span(exact_).first(std::size_t(rays_across()) * std::size_t(rays_across()));
  }
  /// Returns the compared rays of one camera's image.
  Rays compared(const volume::Image& image) const;
  /// Returns the compared rays of images of slices that are blended into eight bits a channel, back to front:
  /// what the viewer itself would show with the same samples.
  Rays in_eight_bits(double step) const;
  /// Number of compared rays across one camera's image.
  int rays_across() const { return edge_ / stride_; }
  /// Returns the greatest certified error bound of the compared rays of a request.
  double greatest_bound(const volume::RenderRequest& request, double step) const;
  /// Available after integrate().
  const Stiffness& stiffness() const { return stiffness_; }
  /// Edge of the images, in pixels.
  int edge() const { return edge_; }

  /// Writes the scene for other programs: its texels to `texels`, and a description to `description`, which
  /// apps/bench/vtk_mappers.py and the bundled viewer's --table can read. Throws std::runtime_error.
  void hand_out(const std::filesystem::path& texels, const std::filesystem::path& description) const;
  const char* texel_type() const;
  const volume::Vec3& spacing() const { return spacing_; }

  const volume::BrickStore& store() const { return *store_; }
  const std::array<int, 3>& size() const { return description_.size; }
  double reference_seconds() const { return reference_seconds_; }

 private:
  /// Returns the greatest change of opacity between samples that are one voxel apart.
  double greatest_change(const volume::RenderRequest& one_voxel, int x, int y) const;
  int pixel(int ray) const { return ray * stride_ + stride_ / 2; }

  int edge_;
  int stride_;
  volume::VolumeDescription description_;
  volume::Vec3 spacing_;
  std::vector<std::byte> texels_;
  std::array<double, 2> value_range_{0, 1};  ///< range of the texels, normalised
  std::unique_ptr<volume::BrickStore> store_;
  std::optional<volume::FieldVariation> variation_;
  volume::Field field_;
  volume::TransferFunction table_;  ///< for a step of one voxel
  Rays exact_;
  Stiffness stiffness_;
  double reference_seconds_ = 0;
};

}  // namespace understudy::launcher::study
