// The texels of a BrickStore as one 3-D texture: a texel per lattice point of the blocks held, so that neither
// borders nor ends that join are the shader's business.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "volume/brick/brick_store.h"
#include "volume/glsl/device.h"
#include "volume/glsl/texture.h"

namespace understudy::volume::glsl {

/// Most bytes of texels that one texture takes.
constexpr std::uint64_t max_field_bytes = std::uint64_t(4) << 30;

class FieldTexture {
 public:
  /// Bytes are widened to 16 bits: some drivers filter 8-bit textures in 8 bits. Wants the device to be
  /// current, as all functions do. Throws NotSupported when the texture would be over a limit, and names it,
  /// or when a texel is not a number: OpenGL's filter need not carry that on.
  FieldTexture(Device& device, const BrickStore& store);

  /// Throws NotSupported as well.
  void blocks_changed(std::span<const std::size_t> blocks);

  GLuint name() const { return texture_.name(); }
  /// Lattice position of the first texel.
  std::array<float, 3> origin() const;
  const std::array<int, 3>& size() const { return size_; }

 private:
  void upload(const std::array<int, 3>& at, const std::array<int, 3>& size, const void* texels);

  Device& device_;
  const BrickStore& store_;
  Texture texture_;
  std::array<int, 3> size_{};
};

}  // namespace understudy::volume::glsl
