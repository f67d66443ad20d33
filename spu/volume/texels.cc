#include "spu/volume/texels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace understudy::spu {
namespace {

constexpr std::size_t slab_bytes = std::size_t(4) << 20;

GLint level_parameter(const DispatchTable& gl, GLenum target, GLenum name) {
  GLint value = 0;
  gl.GetTexLevelParameteriv(target, 0, name, &value);
  return value;
}

GLint texture_parameter(const DispatchTable& gl, GLenum target, GLint sampler, GLenum name) {
  GLint value = 0;
  if (sampler != 0) {
    gl.GetSamplerParameteriv(GLuint(sampler), name, &value);
  } else {
    gl.GetTexParameteriv(target, name, &value);
  }
  return value;
}

std::string name_of_format(GLint format) {
  switch (format) {
    case GL_R8:
      return "R8";
    case GL_R16:
      return "R16";
    case GL_R16F:
      return "R16F";
    case GL_R32F:
      return "R32F";
    case GL_RED:
      return "RED";
    case GL_LUMINANCE:
      return "LUMINANCE";
    case GL_LUMINANCE8:
      return "LUMINANCE8";
    case GL_LUMINANCE16:
      return "LUMINANCE16";
    case GL_INTENSITY:
      return "INTENSITY";
    case GL_INTENSITY8:
      return "INTENSITY8";
    case GL_INTENSITY16:
      return "INTENSITY16";
    case GL_ALPHA:
      return "ALPHA";
    case GL_ALPHA8:
      return "ALPHA8";
    case GL_LUMINANCE_ALPHA:
      return "LUMINANCE_ALPHA";
    case GL_LUMINANCE8_ALPHA8:
      return "LUMINANCE8_ALPHA8";
    case GL_RGB:
      return "RGB";
    case GL_RGB8:
      return "RGB8";
    case GL_RGBA:
      return "RGBA";
    case GL_RGBA8:
      return "RGBA8";
    default: {
      std::array<char, 16> text{};
      std::snprintf(text.data(), text.size(), "0x%04X", unsigned(format));
      return text.data();
    }
  }
}

struct Component {
  BaseFormat base;
  GLenum size;
  GLenum type;
};

/// The component that the base format stores, and its size in bits.
std::optional<std::string> describe_components(const GlContext& context, GLenum target,
                                               TextureDescription& description) {
  const DispatchTable& gl = *context.gl;
  std::vector<Component> asked;
  if (!context.core) {
    asked.push_back({BaseFormat::intensity, GL_TEXTURE_INTENSITY_SIZE, GL_TEXTURE_INTENSITY_TYPE});
    asked.push_back({BaseFormat::luminance, GL_TEXTURE_LUMINANCE_SIZE, GL_TEXTURE_LUMINANCE_TYPE});
  }
  asked.push_back({BaseFormat::red, GL_TEXTURE_RED_SIZE, GL_TEXTURE_RED_TYPE});
  asked.push_back({BaseFormat::alpha, GL_TEXTURE_ALPHA_SIZE, GL_TEXTURE_ALPHA_TYPE});
  const GLint red = level_parameter(gl, target, GL_TEXTURE_RED_SIZE);
  const GLint green = level_parameter(gl, target, GL_TEXTURE_GREEN_SIZE);
  const GLint alpha = level_parameter(gl, target, GL_TEXTURE_ALPHA_SIZE);
  for (const Component& component : asked) {
    const GLint bits = level_parameter(gl, target, component.size);
    if (bits == 0) continue;
    const auto type = GLenum(level_parameter(gl, target, component.type));
    description.base = component.base;
    description.grey = component.base == BaseFormat::luminance && alpha > 0;
    if (description.grey || (red > 0 && green > 0)) {
      description.opaque = alpha == 0;
      if (type != GL_UNSIGNED_NORMALIZED || bits > 8) return "the texture's colours have more than 8 bits";
      description.base = BaseFormat::rgba;
      description.type = volume::TexelType::rgba8;
      return std::nullopt;
    }
    if (type == GL_UNSIGNED_NORMALIZED) {
      description.type = bits <= 8 ? volume::TexelType::u8 : volume::TexelType::u16;
    } else if (type == GL_FLOAT) {
      description.type = volume::TexelType::f32;
    } else {
      return "the texture's texels are neither normalised nor float";
    }
    return std::nullopt;
  }
  return "the texture has no level 0";
}

volume::Wrap wrap_of(GLint mode, volume::Filter filter) {
  switch (mode) {
    case GL_REPEAT:
      return volume::Wrap::repeat;
    case GL_CLAMP_TO_BORDER:
      return volume::Wrap::border;
    // GL_CLAMP clamps the coordinate to [0,1] and filters with the border from there.
    case GL_CLAMP:
      return filter == volume::Filter::linear ? volume::Wrap::border : volume::Wrap::edge;
    // Mirrored modes repeat the edge texel inside [0,1].
    default:
      return volume::Wrap::edge;
  }
}

GLenum pixel_format(BaseFormat base) {
  switch (base) {
    case BaseFormat::alpha:
      return GL_ALPHA;
    case BaseFormat::rgba:
      return GL_RGBA;
    default:
      return GL_RED;  // luminance and intensity answer with their value in red
  }
}

GLenum pixel_type(volume::TexelType type) {
  switch (type) {
    case volume::TexelType::u16:
      return GL_UNSIGNED_SHORT;
    case volume::TexelType::f32:
      return GL_FLOAT;
    default:
      return GL_UNSIGNED_BYTE;
  }
}

constexpr std::array<float, 2> no_range{std::numeric_limits<float>::max(),
                                        std::numeric_limits<float>::lowest()};

void widen(std::array<float, 2>& range, std::span<const std::byte> texels) {
  for (std::size_t i = 0; i + sizeof(float) <= texels.size(); i += sizeof(float)) {
    float value;
    std::memcpy(&value, texels.data() + i, sizeof value);
    if (!std::isfinite(value)) continue;
    range[0] = std::min(range[0], value);
    range[1] = std::max(range[1], value);
  }
}

/// Luminance comes as red, with neither green nor blue.
void spread_luminance(const TextureDescription& description, std::span<std::byte> texels) {
  for (std::size_t i = 0; description.grey && i + 3 < texels.size(); i += 4)
    texels[i + 1] = texels[i + 2] = texels[i];
}

/// The values that a table has to tell about, from those of the texels.
std::array<float, 2> table_range(std::array<float, 2> range, const TextureDescription& description) {
  if (description.type != volume::TexelType::f32 || range[0] > range[1]) return {0.0F, 1.0F};
  for (const volume::Wrap wrap : description.wrap) {
    if (wrap != volume::Wrap::border || !std::isfinite(description.border[0])) continue;
    range[0] = std::min(range[0], description.border[0]);
    range[1] = std::max(range[1], description.border[0]);
  }
  // A constant field has no range to spread a table over: any room above it will do.
  if (range[0] == range[1]) range[1] += std::max(std::abs(range[1]), 1.0F);
  return range;
}

}  // namespace

std::optional<std::string> describe_texture(const GlContext& context, GLenum target, int unit,
                                            TextureDescription& description) {
  const DispatchTable& gl = *context.gl;
  description.size = {level_parameter(gl, target, GL_TEXTURE_WIDTH),
                      level_parameter(gl, target, GL_TEXTURE_HEIGHT),
                      level_parameter(gl, target, GL_TEXTURE_DEPTH)};
  for (const int n : description.size) {
    if (n <= 0) return "the texture is empty";
  }
  if (!context.core && level_parameter(gl, target, GL_TEXTURE_BORDER) != 0) return "the texture has a border";
  if (level_parameter(gl, target, GL_TEXTURE_COMPRESSED) != 0) return "the texture is compressed";
  GLint base_level = 0;
  gl.GetTexParameteriv(target, GL_TEXTURE_BASE_LEVEL, &base_level);
  if (base_level != 0) return "the texture's base level is not 0";
  description.format_name = name_of_format(level_parameter(gl, target, GL_TEXTURE_INTERNAL_FORMAT));
  if (auto reason = describe_components(context, target, description)) return reason;

  GLint sampler = 0;
  if (context.version >= 330) {
    GLint active = 0;
    gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
    gl.GetIntegerv(GL_SAMPLER_BINDING, &sampler);
    gl.ActiveTexture(GLenum(active));
    gl.GetTexParameteriv(target, GL_TEXTURE_SWIZZLE_RGBA, description.swizzle.data());
  }
  const GLint minify = texture_parameter(gl, target, sampler, GL_TEXTURE_MIN_FILTER);
  const GLint magnify = texture_parameter(gl, target, sampler, GL_TEXTURE_MAG_FILTER);
  if (minify != magnify) return "the texture is mip-mapped or filtered differently when minified";
  description.filter = magnify == GL_NEAREST ? volume::Filter::nearest : volume::Filter::linear;
  constexpr std::array<GLenum, 3> axes = {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R};
  for (std::size_t i = 0; i < 3; ++i) {
    description.wrap[i] = wrap_of(texture_parameter(gl, target, sampler, axes[i]), description.filter);
  }
  if (sampler != 0) {
    gl.GetSamplerParameterfv(GLuint(sampler), GL_TEXTURE_BORDER_COLOR, description.border.data());
  } else {
    gl.GetTexParameterfv(target, GL_TEXTURE_BORDER_COLOR, description.border.data());
  }
  if (description.base == BaseFormat::alpha) description.border[0] = description.border[3];
  if (description.grey) description.border[1] = description.border[2] = description.border[0];
  if (description.opaque) description.border[3] = 1;
  if (!context.core) {
    GLfloat scale = 1;
    GLfloat bias = 0;
    GLboolean mapped = GL_FALSE;
    gl.GetFloatv(GL_RED_SCALE, &scale);
    gl.GetFloatv(GL_RED_BIAS, &bias);
    gl.GetBooleanv(GL_MAP_COLOR, &mapped);
    if (scale != 1 || bias != 0 || mapped) return "pixel transfer changes what is read back";
  }
  return std::nullopt;
}

std::array<float, 2> read_texels(const GlContext& context, GLuint texture,
                                 const TextureDescription& description, const volume::TexelBox& box,
                                 const std::function<void(int, int, std::span<const std::byte>)>& slab) {
  const DispatchTable& gl = *context.gl;
  const GLenum format = pixel_format(description.base);
  const GLenum type = pixel_type(description.type);
  const std::size_t texel = volume::bytes_per_texel(description.type);
  const std::array<int, 3> extent{box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]};
  const std::size_t slice = std::size_t(extent[0]) * std::size_t(extent[1]) * texel;
  std::array<float, 2> range = no_range;
  const bool floats = description.type == volume::TexelType::f32;

  if (context.version >= 450) {
    const int slices = int(std::clamp<std::size_t>(slab_bytes / slice, 1, std::size_t(extent[2])));
    std::vector<std::byte> texels(slice * std::size_t(slices));
    for (int z = box.low[2]; z < box.high[2]; z += slices) {
      const int count = std::min(slices, box.high[2] - z);
      const std::size_t bytes = slice * std::size_t(count);
      gl.GetTextureSubImage(texture, 0, box.low[0], box.low[1], z, extent[0], extent[1], count, format, type,
                            GLsizei(bytes), texels.data());
      spread_luminance(description, std::span(texels).first(bytes));
      if (floats) widen(range, std::span(texels).first(bytes));
      slab(z, count, std::span(texels).first(bytes));
    }
  } else {
    // Before OpenGL 4.5 only the whole level can be read: one copy, gone when this returns.
    const std::size_t row = std::size_t(description.size[0]) * texel;
    const std::size_t whole_slice = row * std::size_t(description.size[1]);
    std::vector<std::byte> all(whole_slice * std::size_t(description.size[2]));
    gl.GetTexImage(GL_TEXTURE_3D, 0, format, type, all.data());
    std::vector<std::byte> texels(slice);
    for (int z = box.low[2]; z < box.high[2]; ++z) {
      for (int y = 0; y < extent[1]; ++y) {
        std::memcpy(texels.data() + std::size_t(y) * std::size_t(extent[0]) * texel,
                    all.data() + whole_slice * std::size_t(z) + row * std::size_t(box.low[1] + y) +
                        std::size_t(box.low[0]) * texel,
                    std::size_t(extent[0]) * texel);
      }
      spread_luminance(description, texels);
      if (floats) widen(range, texels);
      slab(z, 1, texels);
    }
  }
  return table_range(range, description);
}

std::optional<std::string> read_stack(const GlContext& context, std::span<const GLuint> textures,
                                      const TextureDescription& description, const volume::TexelBox& box,
                                      const std::function<void(int, int, std::span<const std::byte>)>& slab,
                                      std::array<float, 2>& range) {
  const DispatchTable& gl = *context.gl;
  range = no_range;
  const std::size_t texel = volume::bytes_per_texel(description.type);
  const auto width = std::size_t(box.high[0] - box.low[0]) * texel;
  const auto row = std::size_t(description.size[0]) * texel;
  std::vector<std::byte> whole(row * std::size_t(description.size[1]));
  std::vector<std::byte> part(width * std::size_t(box.high[1] - box.low[1]));
  for (int z = box.low[2]; z < box.high[2]; ++z) {
    gl.BindTexture(GL_TEXTURE_2D, textures[std::size_t(z)]);
    TextureDescription slice;
    if (auto reason = describe_texture(context, GL_TEXTURE_2D, 0, slice)) return reason;
    slice.size[2] = description.size[2];
    if (slice.size != description.size || slice.type != description.type || slice.base != description.base ||
        slice.opaque != description.opaque || slice.grey != description.grey)
      return "the stack's textures differ in size or format";
    gl.GetTexImage(GL_TEXTURE_2D, 0, pixel_format(description.base), pixel_type(description.type),
                   whole.data());
    for (int y = box.low[1]; y < box.high[1]; ++y) {
      std::memcpy(part.data() + std::size_t(y - box.low[1]) * width,
                  whole.data() + std::size_t(y) * row + std::size_t(box.low[0]) * texel, width);
    }
    spread_luminance(description, part);
    if (description.type == volume::TexelType::f32) widen(range, part);
    slab(z, 1, part);
  }
  range = table_range(range, description);
  return std::nullopt;
}

}  // namespace understudy::spu
