// SPDX-License-Identifier: Apache-2.0
// The memory that the texels of a node's volumes may take in textures. Other textures (rays, images, tables,
// distances) are small in comparison and not counted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "volume/glsl/functions.h"

namespace understudy::volume::glsl {

/// Requested memory. Without `bytes`: half of the free memory that the driver reports (GL_NVX_gpu_memory_info,
/// GL_ATI_meminfo), divided by `sharers`; default_texture_memory if it reports none.
struct TextureMemoryWish {
  std::optional<std::uint64_t> bytes;
  int sharers = 1;  ///< nodes that use the same graphics card
};

constexpr std::uint64_t default_texture_memory = std::uint64_t(4) << 30;

/// Free memory as reported by the driver; empty if it reports none. Requires a current context.
std::optional<std::uint64_t> free_texture_memory(const Functions& gl);

class TextureMemory {
 public:
  explicit TextureMemory(std::uint64_t bytes) : bytes_(bytes) {}
  TextureMemory(const TextureMemory&) = delete;
  TextureMemory& operator=(const TextureMemory&) = delete;

  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t left() const { return bytes_ - taken_; }

  /// A part of the memory, released by the destructor.
  class Part {
   public:
    /// `bytes` must be at most left().
    Part(TextureMemory& memory, std::uint64_t bytes) : memory_(memory), bytes_(bytes) {
      memory.taken_ += bytes;
    }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
    ~Part() { memory_.taken_ -= bytes_; }

   private:
    TextureMemory& memory_;
    std::uint64_t bytes_;
  };

 private:
  std::uint64_t bytes_;
  std::uint64_t taken_ = 0;
};

}  // namespace understudy::volume::glsl
