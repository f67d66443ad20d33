// Ray casting in a fragment shader: what the ray caster on the CPU draws (raycast/ray_caster.h), from one 3-D
// texture in an OpenGL context of its own. It takes the same samples, at the same float positions; what differs
// is OpenGL's filter, which is exact to 1e-6 on llvmpipe and has weights of 8 bits on most graphics cards.
// Where a table is so steep that this would show, the shader interpolates by itself, in float.
//
// It draws scalar fields under transfer functions and colours under linear maps, on planes and on steps, under
// every operator. Tables of pairs, fog, segments, surfaces, light, texels that are not numbers, and volumes or
// pictures over OpenGL's limits are for the CPU.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volume/glsl/device.h"
#include "volume/raycast/brick_renderer.h"

namespace understudy::volume::glsl {

class GlslRayCaster final : public BrickRenderer {
 public:
  /// `store` and `device` must outlive it. The texture is made at the first render().
  GlslRayCaster(const BrickStore& store, Device& device);
  ~GlslRayCaster() override;

  /// Why requests like this one are not drawn here, in one line; empty when they are.
  std::optional<std::string> obstacle(const RenderRequest& request) const;

  void blocks_changed(std::span<const std::size_t> blocks) override;
  /// Throws as RayCaster::render() does, and NotSupported, after which the CPU can be asked. `samples_taken`
  /// includes those that share a stretch of eight with a block that shows something.
  void render(const RenderRequest& request, Image& out, FrameCounts& counts) override;

 private:
  struct Prepared;
  struct Rays;
  struct Resources;

  void set_uniforms(const MarchProgram& program, const RenderRequest& request, const Prepared& prepared,
                    const std::array<float, 3>& top, const std::array<float, 3>& rounding) const;

  const BrickStore& store_;
  Device& device_;
  std::unique_ptr<Resources> resources_;
  std::vector<std::size_t> changed_;  ///< blocks, since the last render()
};

}  // namespace understudy::volume::glsl
