// SPDX-License-Identifier: Apache-2.0
// Interface of whatever draws the cells of a BrickStore: the ray caster on the CPU, or another renderer with
// the same contract (raycast/ray_caster.h). Owners of bricks are given a factory for it.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>

namespace understudy::volume {

class BrickStore;
class Occlusion;
struct FrameCounts;
struct Image;
struct Rect;
struct RenderRequest;

class BrickRenderer {
 public:
  virtual ~BrickRenderer() = default;

  /// The texels of these blocks of the store have changed since the last render().
  virtual void blocks_changed(std::span<const std::size_t> blocks) = 0;

  /// Renders the pixels of `out.rect` that lie in the request's window. All others become neutral, and so may
  /// those that `occlusion` hides. Reports to `occlusion` what these bricks hide.
  void render(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion = nullptr) {
    draw(request, out, counts, occlusion);
  }

  /// Estimates the cost of render() in each of `tiles`, in a unit of the renderer's choice; `costs` has one
  /// element per tile. By default, a tile's number of pixels.
  virtual void estimate_costs(const RenderRequest& request, std::span<const Rect> tiles,
                              std::span<float> costs);

 protected:
  virtual void draw(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) = 0;

  BrickRenderer() = default;
  BrickRenderer(const BrickRenderer&) = default;
  BrickRenderer(BrickRenderer&&) = default;
  BrickRenderer& operator=(const BrickRenderer&) = default;
  BrickRenderer& operator=(BrickRenderer&&) = default;
};

/// The store outlives the renderers made for it.
using BrickRendererFactory = std::function<std::unique_ptr<BrickRenderer>(const BrickStore&)>;

/// The ray caster on the CPU.
std::unique_ptr<BrickRenderer> cpu_renderer(const BrickStore& store);

}  // namespace understudy::volume
