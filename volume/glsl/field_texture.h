// SPDX-License-Identifier: Apache-2.0
// The texels of a BrickStore as one 3D texture, with one texel per lattice point of the blocks held, so that
// the shader need handle neither texture borders nor repeating axes.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "volume/brick/brick_store.h"
#include "volume/glsl/device.h"
#include "volume/glsl/texture.h"

namespace understudy::volume::glsl {

class FieldTexture {
 public:
  /// Whether one texture can hold all texels, given OpenGL's largest texture edge and the device's remaining
  /// memory.
  static bool fits(const Device& device, const BrickStore& store);

  /// Requires fits() and, like all functions, the device to be current. Throws OutOfMemory, and NotSupported
  /// when a texel is NaN.
  FieldTexture(Device& device, const BrickStore& store);

  /// Also throws NotSupported.
  void blocks_changed(std::span<const std::size_t> blocks);

  GLuint name() const { return texture_.name(); }
  const std::array<int, 3>& size() const { return size_; }

 private:
  static std::array<int, 3> size_of(const BrickStore& store);
  static std::uint64_t bytes_of(const BrickStore& store);
  void upload(const std::array<int, 3>& at, const std::array<int, 3>& size, const void* texels);

  Device& device_;
  const BrickStore& store_;
  TextureMemory::Part memory_;
  Texture texture_;
  std::array<int, 3> size_{};
};

}  // namespace understudy::volume::glsl
