// SPDX-License-Identifier: Apache-2.0
// Reads a volume's texels from the driver.
//
// However the application uploaded the texels (whole, slice by slice, from a buffer, copied, defined twice),
// the driver has the result. It is read when a draw is recognised, slice range by slice range, and goes
// directly into bricks. No copy is kept here.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "dispatch/table.h"
#include "volume/rgba.h"
#include "volume/texel_box.h"
#include "volume/texel_type.h"
#include "volume/texture_filter.h"

namespace understudy::spu {

struct GlContext;

/// What the pipeline gets when it samples the texture.
enum class BaseFormat { red, luminance, intensity, alpha, rgba };

struct TextureDescription {
  std::array<int, 3> size{};
  volume::TexelType type = volume::TexelType::u8;
  std::array<float, 2> held{0, 1};  ///< the least and the greatest value of the format
  int steps = 255;                  ///< texels are multiples of 1 / steps; 0: floats
  BaseFormat base = BaseFormat::red;
  bool opaque = false;  ///< colours without alpha: alpha is 1 everywhere
  bool grey = false;    ///< colours are luminance with alpha
  volume::Filter filter = volume::Filter::linear;
  std::array<volume::Wrap, 3> wrap{};
  volume::Rgba border{};
  std::array<GLint, 4> swizzle{GL_RED, GL_GREEN, GL_BLUE, GL_ALPHA};
  std::string format_name;  ///< for the report: "INTENSITY8", "R16F"
};

/// Describes the texture bound to `target` of the active unit. Returns a reason if it is not a volume that can
/// be held.
std::optional<std::string> describe_texture(const GlContext& context, GLenum target, int unit,
                                            TextureDescription& description);

/// Returns the internal format of a float texture that is sampled like one of base format `base`.
GLenum probe_format(BaseFormat base);
/// The same with one byte per component.
GLenum byte_probe_format(BaseFormat base);
/// The same with 16 bits per component.
GLenum word_probe_format(BaseFormat base);
GLenum upload_format(BaseFormat base);

/// Reads any box of texels. Expects tight pixel packing (SavedState).
class TexelSource {
 public:
  virtual ~TexelSource() = default;
  /// Texels are tightly packed, x fastest. Throws std::runtime_error with a reason.
  virtual void read(const volume::TexelBox& box, std::span<std::byte> texels) = 0;
};

/// The 3-D texture bound to the active unit.
std::unique_ptr<TexelSource> texture_source(const GlContext& context, GLuint texture,
                                            const TextureDescription& description);

/// A stack of 2-D textures, which are bound to the active unit one by one. Refuses textures that are not alike.
std::unique_ptr<TexelSource> stack_source(const GlContext& context, std::span<const GLuint> textures,
                                          const TextureDescription& description);

}  // namespace understudy::spu
