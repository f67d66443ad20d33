// SPDX-License-Identifier: Apache-2.0
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

class FieldTexture {
 public:
  /// Whether one texture may hold all of it: by the longest edge that OpenGL takes, and by what is left of the
  /// device's memory.
  static bool fits(const Device& device, const BrickStore& store);

  /// What fits(). Wants the device to be current, as all functions do. Throws OutOfMemory, and NotSupported
  /// when a texel is not a number.
  FieldTexture(Device& device, const BrickStore& store);

  /// Throws NotSupported as well.
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
