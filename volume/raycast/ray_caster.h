// SPDX-License-Identifier: Apache-2.0
// Ray casting on the CPU: composites the samples that the application's own slices would have shown, as far as
// they lie in the cells that a BrickStore owns.
//
// Sample i of a pixel lies where the pixel's ray crosses plane i of the request. Every rank computes
// bit-identical sample positions and takes only the samples in its own cells. The images of all ranks,
// composited in visibility order, therefore equal the image of one rank that owns everything (up to the
// rounding of float compositing and the termination threshold).
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

/// Most slice planes that are accepted.
constexpr int max_planes = 1 << 22;

/// The value of pixels that no sample reached: compositing it changes nothing. Under `min` this is the largest
/// float, so that GL_MIN ignores such pixels; otherwise 0.
constexpr float neutral_value(Operator op) {
  return op == Operator::min ? std::numeric_limits<float>::max() : 0.0F;
}

/// Throws std::invalid_argument when `request` cannot be rendered on `volume`: singular matrix, values that are
/// not finite, planes without direction, too many planes, a classification that does not fit the texel type.
void validate(const VolumeDescription& volume, const RenderRequest& request);

class RayCaster {
 public:
  /// `store` must outlive the ray caster and be finished before the first render().
  explicit RayCaster(const BrickStore& store);
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// The texels of these blocks have changed since the last render(): data derived from them is recomputed.
  void blocks_changed(std::span<const std::size_t> blocks);

  /// Renders the pixels of `out.rect` that lie in the request's window; all others become neutral. Runs on all
  /// cores of the calling TBB arena. Data that depends only on the classification is cached for the two most
  /// recent classifications.
  ///
  /// Adds to `counts`: rays with at least one sample in the owned cells, how many of them became opaque, the
  /// samples in the owned cells (including skipped ones) and those taken, the blocks held and those empty under
  /// the classification. Over ranks, the sum of `samples` is the same for every partition, while a ray counts
  /// on every rank that it crosses. Bytes and times are left to the caller. Throws as validate() does, and
  /// std::logic_error for an unfinished store.
  ///
  /// `occlusion`, for requests that can occlude, is queried before a tile and updated after it. The samples of
  /// hidden tiles count as hidden.
  void render(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion = nullptr);

  /// Estimates the cost of render() in each of `tiles`, in samples, by casting one in 64 of their rays. Sums
  /// over ranks give the cost of the image, except for what ranks in front hide. `costs` has one element per
  /// tile. Throws as render() does.
  void estimate_costs(const RenderRequest& request, std::span<const Rect> tiles, std::span<float> costs);

 private:
  struct Prepared;

  Prepared& prepare(const RenderRequest& request);

  const BrickStore* store_;
  /// Most recent first. Two, because viewers whose framebuffer keeps alpha request two images per frame.
  std::array<std::unique_ptr<Prepared>, 2> prepared_;
};

/// Renders one image without caching anything.
void raycast(const BrickStore& store, const RenderRequest& request, Image& out, FrameCounts& counts);

/// The instruction set that the kernels use on this machine, e.g. "AVX2".
const char* instruction_set();

}  // namespace understudy::volume
