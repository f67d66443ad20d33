// SPDX-License-Identifier: Apache-2.0
// Ray casting in a fragment shader: draws what the ray caster on the CPU draws (raycast/ray_caster.h), from one
// 3D texture in an OpenGL context of its own, or, if that would exceed OpenGL's limits or the device's memory,
// from as many bricks as fit, in passes (brick_passes.h). It takes the same samples, at the same float
// positions. The difference is OpenGL's filter, which is exact to 1e-6 on llvmpipe and has weights of 8 bits on
// most graphics cards. For tables so steep that this would be visible, the shader itself interpolates in float.
//
// Supports scalar fields under transfer functions and colours under linear maps, on planes and on steps, under
// every operator. The CPU draws pre-integration tables, fog, segments, surfaces, light, NaN texels, and images
// that exceed OpenGL's limits.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volume/frame_counts.h"
#include "volume/glsl/brick_size.h"
#include "volume/glsl/device.h"
#include "volume/image.h"
#include "volume/raycast/brick_renderer.h"

namespace understudy::volume::glsl {

/// Statistics of a volume's bricks.
struct BrickFigures {
  std::size_t bricks = 0;  ///< in the volume; 0 if one texture holds it all
  std::size_t slots = 0;   ///< that can be resident at a time
  int passes = 0;          ///< of the last image
  std::uint64_t uploads = 0, evictions = 0;
};

class GlslRayCaster final : public BrickRenderer {
 public:
  /// `store` and `device` must outlive it. Textures are created by the first render(). `brick_cells` is a power
  /// of two, 8 or more.
  GlslRayCaster(const BrickStore& store, Device& device, int brick_cells = usual_brick_cells);
  ~GlslRayCaster() override;

  /// Why requests like this one are not supported, in one line; empty if they are.
  std::optional<std::string> obstacle(const RenderRequest& request) const;

  BrickFigures brick_figures() const;

  void blocks_changed(std::span<const std::size_t> blocks) override;

 private:
  /// Throws as RayCaster::render() does, and NotSupported, after which the CPU can draw. `samples_taken`
  /// includes empty samples in a run of eight that begins in a visible block. Hidden tiles are drawn as well:
  /// one draw call covers all tiles.
  void draw(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) override;
  void draw_all(const RenderRequest& request, Image& out, FrameCounts& counts);

  struct Prepared;
  struct Rays;
  struct Resources;

  /// Throws as draw() does if request, store or image are invalid or unsupported.
  void check_drawable(const RenderRequest& request, const Image& out) const;
  /// Uploads the changed blocks and the data derived from them.
  void follow_changes(Resources& here);
  const Prepared& prepared_for(const RenderRequest& request, Resources& here);
  const MarchProgram& program_for(const RenderRequest& request, const Prepared& prepared,
                                  const Resources& here);
  /// Draws all rays in one pass, if one texture holds the field.
  void draw_whole(const Rect& pixels, Image& out, FrameCounts& counts, Resources& here) const;
  /// The bricks that show something in these pixels, in visibility order.
  std::vector<std::size_t> visible_bricks(const RenderRequest& request, const Prepared& prepared,
                                          const Rect& pixels) const;
  void set_uniforms(const MarchProgram& program, const RenderRequest& request, const Prepared& prepared,
                    const std::array<float, 3>& top, const std::array<float, 3>& rounding) const;

  const BrickStore& store_;
  Device& device_;
  int brick_cells_;
  std::unique_ptr<Resources> resources_;
  std::vector<std::size_t> changed_;  ///< blocks changed since the last render()
};

}  // namespace understudy::volume::glsl
