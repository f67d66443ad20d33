// SPDX-License-Identifier: Apache-2.0
// Ray casting on the CPU: composites the samples that the application's own slices would have shown, as far
// as they fall in the cells that a BrickStore owns.
//
// Sample i of a pixel lies where the pixel's ray meets plane i of the request. Every rank computes
// bit-identical sample positions and counts the samples of its own cells only, so the images of all ranks,
// composed in visibility order, equal the image of one rank that owns everything (up to the rounding of
// float composition and the termination threshold).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "volume/blending_operator.h"

namespace understudy::volume {

class BrickStore;
class Occlusion;
struct FrameCounts;
struct Image;
struct Rect;
struct RenderRequest;
struct VolumeDescription;

/// Most slice planes that are believed.
constexpr int max_planes = 1 << 22;

/// What a pixel holds that no sample reached: composing it changes nothing. Under `min` this is the largest
/// float, so that GL_MIN leaves such pixels alone; otherwise 0.
constexpr float neutral_value(Operator op) {
  return op == Operator::min ? std::numeric_limits<float>::max() : 0.0F;
}

/// Throws std::invalid_argument when `request` cannot be rendered on `volume`: singular matrix, values that
/// are not finite, planes without direction, too many planes, a classification that does not fit the texel
/// type.
void validate(const VolumeDescription& volume, const RenderRequest& request);

class RayCaster {
 public:
  /// `store` must outlive the ray caster and be finished before the first render().
  explicit RayCaster(const BrickStore& store);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// These blocks of the store show other texels than at the last render(): what is kept of them is made anew.
  void blocks_changed(std::span<const std::size_t> blocks);

  /// Renders the pixels of `out.rect` that lie in the request's window; all others become neutral. Runs on
  /// all cores of the calling TBB arena. What depends on the classification alone is kept for the next two
  /// calls.
  ///
  /// Adds to `counts`: rays with at least one sample in the owned cells, of these the rays that became
  /// opaque, the samples in the owned cells (had nothing been left out) and those taken, the blocks held and
  /// those empty under the classification. Sums over ranks: `samples` is the same for every partition, a ray
  /// counts on every rank it crosses. Leaves bytes and times to the caller. Throws as validate() does, and
  /// std::logic_error on an unfinished store.
  ///
  /// `occlusion`, where requests can occlude, is asked before a tile and told after it. The samples of hidden
  /// tiles count as hidden.
  void render(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion = nullptr);

  /// What render() would cost in each of `tiles`, in samples: some of their rays are cast, a 64th of all. Sums
  /// over ranks are those of the image, but for what ranks in front hide. `costs` has a number for each tile.
  /// Throws as render() does.
  void estimate_costs(const RenderRequest& request, std::span<const Rect> tiles, std::span<float> costs);

 private:
  struct Prepared;

  Prepared& prepare(const RenderRequest& request);

  const BrickStore* store_;
  /// The latest first: a viewer whose framebuffer keeps alpha asks for two images of every frame.
  std::array<std::unique_ptr<Prepared>, 2> prepared_;
};

/// One image without keeping anything.
void raycast(const BrickStore& store, const RenderRequest& request, Image& out, FrameCounts& counts);

/// The instruction set that the kernels run with on this machine, e.g. "AVX2".
const char* instruction_set();

}  // namespace understudy::volume
