// SPDX-License-Identifier: Apache-2.0
// What a study looks at: a volume, a transfer function and several cameras, with the double-precision integral
// of some of their rays.
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
  std::string shows;   ///< why it is looked at, in a few words
  std::string volume;  ///< a file, or "synthetic:..."
  volume::TransferControlPoints control_points;
  volume::Vec3 spacing{};  ///< zeros: the file's own
};

/// Scenes that need no file.
std::vector<SceneDescription> built_in_scenes();

/// How stiff a scene is for samples one voxel apart.
struct Stiffness {
  double depth = 0;   ///< the greatest optical depth of a voxel that a value of the volume has
  double change = 0;  ///< the greatest change of opacity from one sample on a compared ray to the next

  bool operator==(const Stiffness&) const = default;
};

class Scene {
 public:
  /// Every `stride`-th pixel across and up of each camera's image of `edge`^2 pixels is compared. Reads the
  /// volume. Throws volume::FileError, std::invalid_argument.
  Scene(const SceneDescription& description, int edge, int stride);

  /// Of different sides, heights and distances. The first is the one that other programs show.
  static std::span<const volume::OrbitCamera> cameras();
  /// One sample every `step` voxels (of the smallest spacing) along each ray of a camera.
  volume::RenderRequest request(double step, volume::Method method, double termination,
                                const volume::OrbitCamera& camera) const;

  /// Integrates the rays that are compared; a hundredth after the other is told to `progress`.
  void integrate(const std::function<void(double done)>& progress);

  /// Rays that are compared: premultiplied colour and opacity, row by row from the bottom, camera by camera.
  using Rays = std::vector<std::array<double, 4>>;
  const Rays& exact() const { return exact_; }
  /// Those of the first camera.
  std::span<const std::array<double, 4>> exact_of_first_camera() const {
    return std::span(exact_).first(std::size_t(rays_across()) * std::size_t(rays_across()));
  }
  /// Of one camera's image.
  Rays compared(const volume::Image& image) const;
  /// The images of slices blended into eight bits a channel, back to front: what the viewer itself would show
  /// of the same samples.
  Rays in_eight_bits(double step) const;
  /// Of one camera.
  int rays_across() const { return edge_ / stride_; }
  /// Of the rays that are compared, in an image of samples.
  double greatest_bound(const volume::RenderRequest& request, double step) const;
  /// Known once rays are integrated.
  const Stiffness& stiffness() const { return stiffness_; }
  /// Of the images, in pixels.
  int edge() const { return edge_; }

  /// The scene for other programs: its texels in `texels`, and in `description` what apps/bench/vtk_mappers.py
  /// and the bundled viewer's --table read. Throws std::runtime_error.
  void hand_out(const std::filesystem::path& texels, const std::filesystem::path& description) const;
  const char* texel_type() const;
  const volume::Vec3& spacing() const { return spacing_; }

  const volume::BrickStore& store() const { return *store_; }
  const std::array<int, 3>& size() const { return description_.size; }
  double reference_seconds() const { return reference_seconds_; }

 private:
  void integrate_row(const volume::RenderRequest& one_voxel, std::span<std::array<double, 4>> row, int y);
  /// Between samples one voxel apart.
  double greatest_change(const volume::RenderRequest& one_voxel, int x, int y) const;
  int pixel(int ray) const { return ray * stride_ + stride_ / 2; }

  int edge_;
  int stride_;
  volume::VolumeDescription description_;
  volume::Vec3 spacing_;
  std::vector<std::byte> texels_;
  std::array<double, 2> value_range_{0, 1};  ///< of the texels, normalised
  std::unique_ptr<volume::BrickStore> store_;
  std::optional<volume::FieldVariation> variation_;
  volume::Field field_;
  volume::TransferFunction table_;  ///< for a step of one voxel
  Rays exact_;
  Stiffness stiffness_;
  double reference_seconds_ = 0;
};

}  // namespace understudy::launcher::study
