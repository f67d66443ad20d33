// SPDX-License-Identifier: Apache-2.0
// What draws the cells of one BrickStore: the ray caster on the CPU, or another that keeps its contract
// (raycast/ray_caster.h). Whoever holds bricks is given the means to make one.
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

  /// These blocks of the store show other texels than at the last render().
  virtual void blocks_changed(std::span<const std::size_t> blocks) = 0;

  /// Renders the pixels of `out.rect` that lie in the request's window; all others become neutral, and so may
  /// those that `occlusion` hides. It is told of what these bricks hide.
  void render(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion = nullptr) {
    draw(request, out, counts, occlusion);
  }

  /// The estimated cost of render() in each of `tiles`, in a unit of its own; `costs` has a number for
  /// each tile. Where a renderer cannot tell, their pixels.
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

/// The store outlives what is made for it.
using BrickRendererFactory = std::function<std::unique_ptr<BrickRenderer>(const BrickStore&)>;

/// The ray caster on the CPU.
std::unique_ptr<BrickRenderer> cpu_renderer(const BrickStore& store);

}  // namespace understudy::volume
