// The volume itself, read from the driver.
//
// Whatever way the texels went up (whole, slice by slice, from a buffer, copied, defined twice), the driver
// holds the result; it is read when a draw is recognised, slab by slab, and goes straight into bricks. No copy
// stays here.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "spu/volume/context.h"
#include "volume/request.h"

namespace understudy::spu {

/// What the pipeline sees when it samples the texture.
enum class BaseFormat { red, luminance, intensity, alpha, rgba };

struct TextureDescription {
  std::array<int, 3> size{};
  volume::TexelType type = volume::TexelType::u8;
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

/// Reads the texels of `box` from the 3-D texture bound to the active unit and hands them on in slabs of whole
/// slices (first slice, number, texels tightly packed). Expects tight pixel packing (SavedState). Returns the
/// range of finite values for f32, [0,1] otherwise.
std::array<float, 2> read_texels(const GlContext& context, GLuint texture,
                                 const TextureDescription& description, const volume::TexelBox& box,
                                 const std::function<void(int, int, std::span<const std::byte>)>& slab);

/// The same from a stack of 2-D textures, slice by slice; binds them to the active unit. A reason where they
/// are not alike.
std::optional<std::string> read_stack(const GlContext& context, std::span<const GLuint> textures,
                                      const TextureDescription& description, const volume::TexelBox& box,
                                      const std::function<void(int, int, std::span<const std::byte>)>& slab,
                                      std::array<float, 2>& range);

}  // namespace understudy::spu
