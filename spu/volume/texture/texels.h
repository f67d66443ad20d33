// SPDX-License-Identifier: Apache-2.0
// The volume itself, read from the driver.
//
// Whatever way the texels went up (whole, slice by slice, from a buffer, copied, defined twice), the driver
// holds the result; it is read when a draw is recognised, slice range by slice range, and goes straight into
// bricks. No copy stays here.
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

/// What the pipeline sees when it samples the texture.
enum class BaseFormat { red, luminance, intensity, alpha, rgba };

struct TextureDescription {
  std::array<int, 3> size{};
  volume::TexelType type = volume::TexelType::u8;
  std::array<float, 2> held{0, 1};  ///< the least and the greatest number that the format holds
  int steps = 255;                  ///< texels are multiples of 1 / steps; 0: floats
  BaseFormat base = BaseFormat::red;
  bool opaque = false;  ///< colours without alpha: it is 1 everywhere
  bool grey = false;    ///< colours are luminance and alpha
  volume::Filter filter = volume::Filter::linear;
  std::array<volume::Wrap, 3> wrap{};
  volume::Rgba border{};
  std::array<GLint, 4> swizzle{GL_RED, GL_GREEN, GL_BLUE, GL_ALPHA};
  std::string format_name;  ///< for the report: "INTENSITY8", "R16F"
};

/// Describes the texture bound to `target` of the active unit. A reason where it is not a volume that we can
/// hold.
std::optional<std::string> describe_texture(const GlContext& context, GLenum target, int unit,
                                            TextureDescription& description);

/// Of a float texture that reads like one of base format `base`: internal format, and format of its texels.
GLenum probe_format(BaseFormat base);
/// The same with one byte a component.
GLenum byte_probe_format(BaseFormat base);
GLenum upload_format(BaseFormat base);

/// Where texels are read from, any box of them. Expects tight pixel packing (SavedState).
class TexelSource {
 public:
  virtual ~TexelSource() = default;
  /// Tightly packed, x fastest. Throws std::runtime_error with a reason.
  virtual void read(const volume::TexelBox& box, std::span<std::byte> texels) = 0;
};

/// The 3-D texture bound to the active unit.
std::unique_ptr<TexelSource> texture_source(const GlContext& context, GLuint texture,
                                            const TextureDescription& description);

/// A stack of 2-D textures, which are bound to the active unit one by one. Those that are not alike are
/// refused.
std::unique_ptr<TexelSource> stack_source(const GlContext& context, std::span<const GLuint> textures,
                                          const TextureDescription& description);

}  // namespace understudy::spu
