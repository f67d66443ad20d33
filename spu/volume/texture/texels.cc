// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/texture/texels.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <vector>

#include "spu/volume/context/context.h"
#include "spu/volume/texture/texture_parameter.h"

namespace understudy::spu {
namespace {

GLint level_parameter(const DispatchTable& gl, GLenum target, GLenum name) {
  GLint value = 0;
  gl.GetTexLevelParameteriv(target, 0, name, &value);
  return value;
}

std::string name_of_format(GLint format) {
  switch (format) {
    case GL_R8:
      return "R8";
    case GL_R8_SNORM:
      return "R8_SNORM";
    case GL_R16:
      return "R16";
    case GL_R16_SNORM:
      return "R16_SNORM";
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

/// Whether colours, but not alpha, are stored as sRGB. Compressed formats are not listed.
bool is_srgb(GLint format) {
  switch (format) {
    case GL_SRGB:
    case GL_SRGB8:
    case GL_SRGB_ALPHA:
    case GL_SRGB8_ALPHA8:
    case GL_SLUMINANCE:
    case GL_SLUMINANCE8:
    case GL_SLUMINANCE_ALPHA:
    case GL_SLUMINANCE8_ALPHA8:
    case GL_SR8_EXT:
    case GL_SRG8_EXT:
      return true;
    default:
      return false;
  }
}

struct Component {
  BaseFormat base;
  GLenum size;
  GLenum type;
};

/// Determines the component that the base format stores, and its size in bits.
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
      description.steps = bits <= 8 ? 255 : 65535;
    } else if (type == GL_SIGNED_NORMALIZED) {
      // Most computed tomographies (VTK, ITK): read as the values from -1 to 1 that the pipeline gets.
      description.type = volume::TexelType::f32;
      description.held = {-1, 1};
      description.steps = bits <= 8 ? 127 : 32767;
    } else if (type == GL_FLOAT) {
      description.type = volume::TexelType::f32;
      description.held = {-std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
      description.steps = 0;
    } else {
      return "the texture's texels are integers";
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
    // GL_CLAMP clamps the coordinate to [0,1]; there the linear filter includes the border.
    case GL_CLAMP:
      return filter == volume::Filter::linear ? volume::Wrap::border : volume::Wrap::edge;
    // Within [0,1], mirrored modes repeat the edge texel.
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
      return GL_RED;  // luminance and intensity are returned as red
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

/// Copies luminance, which is read as red, to green and blue.
void spread_luminance(const TextureDescription& description, std::span<std::byte> texels) {
  for (std::size_t i = 0; description.grey && i + 3 < texels.size(); i += 4)
    texels[i + 1] = texels[i + 2] = texels[i];
}

class BoundTexture final : public TexelSource {
 public:
  BoundTexture(const GlContext& context, GLuint texture, const TextureDescription& description)
      : context_(context), texture_(texture), description_(description) {}

  void read(const volume::TexelBox& box, std::span<std::byte> texels) override {
    read_as_stored(box, texels);
    spread_luminance(description_, texels);
  }

 private:
  void read_as_stored(const volume::TexelBox& box, std::span<std::byte> texels) {
    const DispatchTable& gl = *context_.gl;
    const GLenum format = pixel_format(description_.base);
    const GLenum type = pixel_type(description_.type);
    if (context_.version >= 450) {
      gl.GetTextureSubImage(texture_, 0, box.low[0], box.low[1], box.low[2], box.high[0] - box.low[0],
                            box.high[1] - box.low[1], box.high[2] - box.low[2], format, type,
                            GLsizei(texels.size()), texels.data());
      return;
    }
    // Before OpenGL 4.5 only the whole level can be read: one copy, freed with this source.
    const std::size_t texel = volume::bytes_per_texel(description_.type);
    const volume::TexelBox whole{{0, 0, 0}, description_.size};
    if (level_.empty()) {
      level_.resize(volume::texels_in(whole) * texel);
      gl.GetTexImage(GL_TEXTURE_3D, 0, format, type, level_.data());
    }
    volume::copy_texels(box, texel, whole, level_, box, texels);
  }

  const GlContext& context_;
  GLuint texture_;
  TextureDescription description_;
  std::vector<std::byte> level_;
};

class Stack final : public TexelSource {
 public:
  Stack(const GlContext& context, std::span<const GLuint> textures, const TextureDescription& description)
      : context_(context), textures_(textures), description_(description) {}

  void read(const volume::TexelBox& box, std::span<std::byte> texels) override {
    const DispatchTable& gl = *context_.gl;
    const std::size_t texel = volume::bytes_per_texel(description_.type);
    volume::TexelBox slice{{0, 0, 0}, {description_.size[0], description_.size[1], 0}};
    for (int z = box.low[2]; z < box.high[2]; ++z) {
      gl.BindTexture(GL_TEXTURE_2D, textures_[std::size_t(z)]);
      TextureDescription found;
      if (const auto reason = describe_texture(context_, GL_TEXTURE_2D, 0, found))
        throw std::runtime_error(*reason);
      found.size[2] = description_.size[2];
      if (found.size != description_.size || found.type != description_.type ||
          found.base != description_.base || found.opaque != description_.opaque ||
          found.grey != description_.grey)
        throw std::runtime_error("the stack's textures differ in size or format");
      slice.low[2] = z;
      slice.high[2] = z + 1;
      slice_.resize(volume::texels_in(slice) * texel);
      gl.GetTexImage(GL_TEXTURE_2D, 0, pixel_format(description_.base), pixel_type(description_.type),
                     slice_.data());
      volume::copy_texels(volume::intersection(box, slice), texel, slice, slice_, box, texels);
    }
    spread_luminance(description_, texels);
  }

 private:
  const GlContext& context_;
  std::span<const GLuint> textures_;
  TextureDescription description_;
  std::vector<std::byte> slice_;
};

/// Returns whether samples can only be of level 0, which is the base level.
bool has_one_level(const GlContext& context, GLenum target) {
  const DispatchTable& gl = *context.gl;
  GLint last = 0;
  gl.GetTexParameteriv(target, GL_TEXTURE_MAX_LEVEL, &last);
  if (last == 0) return true;
  // In a texture with immutable storage, the last level is at most the last that it has.
  GLint levels = 0;
  if (context.version >= 430) gl.GetTexParameteriv(target, GL_TEXTURE_IMMUTABLE_LEVELS, &levels);
  return levels == 1;
}

/// Returns the minifying filter, without its mipmap part if only level 0 can be sampled.
GLenum minifying_filter(const GlContext& context, GLenum target, GLint sampler) {
  const auto filter = GLenum(texture_parameter(*context.gl, target, sampler, GL_TEXTURE_MIN_FILTER));
  if (filter == GL_NEAREST || filter == GL_LINEAR || !has_one_level(context, target)) return filter;
  return filter == GL_NEAREST_MIPMAP_NEAREST || filter == GL_NEAREST_MIPMAP_LINEAR ? GL_NEAREST : GL_LINEAR;
}

/// Whether pixel transfer changes any component of what glGetTexImage() returns.
bool changes_what_is_read(const DispatchTable& gl) {
  GLboolean mapped = GL_FALSE;
  gl.GetBooleanv(GL_MAP_COLOR, &mapped);
  const auto differs = [&](GLenum name, GLfloat neutral) {
    GLfloat value = neutral;
    gl.GetFloatv(name, &value);
    return value != neutral;
  };
  constexpr std::array<GLenum, 4> scales{GL_RED_SCALE, GL_GREEN_SCALE, GL_BLUE_SCALE, GL_ALPHA_SCALE};
  constexpr std::array<GLenum, 4> biases{GL_RED_BIAS, GL_GREEN_BIAS, GL_BLUE_BIAS, GL_ALPHA_BIAS};
  return mapped || std::ranges::any_of(scales, [&](GLenum scale) { return differs(scale, 1); }) ||
         std::ranges::any_of(biases, [&](GLenum bias) { return differs(bias, 0); });
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
  const GLint format = level_parameter(gl, target, GL_TEXTURE_INTERNAL_FORMAT);
  description.format_name = name_of_format(format);
  if (auto reason = describe_components(context, target, description)) return reason;

  GLint sampler = 0;
  if (context.version >= 330) {
    GLint active = 0;
    gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
    sampler = bound_sampler(context);
    gl.ActiveTexture(GLenum(active));
    gl.GetTexParameteriv(target, GL_TEXTURE_SWIZZLE_RGBA, description.swizzle.data());
  }
  // What is read back is not decoded.
  if (is_srgb(format) && decodes_srgb(context, target, sampler))
    return "the texture's colours are decoded from sRGB";
  const auto magnify = GLenum(texture_parameter(gl, target, sampler, GL_TEXTURE_MAG_FILTER));
  if (minifying_filter(context, target, sampler) != magnify)
    return "the texture is mip-mapped or filtered differently when minified";
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
  for (float& component : description.border)
    component = std::clamp(component, description.held[0], description.held[1]);
  if (description.base == BaseFormat::alpha) description.border[0] = description.border[3];
  if (description.grey) description.border[1] = description.border[2] = description.border[0];
  if (description.opaque) description.border[3] = 1;
  if (!context.core && changes_what_is_read(gl)) return "pixel transfer changes what is read back";
  return std::nullopt;
}

std::unique_ptr<TexelSource> texture_source(const GlContext& context, GLuint texture,
                                            const TextureDescription& description) {
  return std::make_unique<BoundTexture>(context, texture, description);
}

std::unique_ptr<TexelSource> stack_source(const GlContext& context, std::span<const GLuint> textures,
                                          const TextureDescription& description) {
  return std::make_unique<Stack>(context, textures, description);
}

GLenum probe_format(BaseFormat base) {
  switch (base) {
    case BaseFormat::luminance:
      return GL_LUMINANCE32F_ARB;
    case BaseFormat::intensity:
      return GL_INTENSITY32F_ARB;
    case BaseFormat::alpha:
      return GL_ALPHA32F_ARB;
    case BaseFormat::rgba:
      return GL_RGBA32F;
    default:
      return GL_R32F;
  }
}

GLenum byte_probe_format(BaseFormat base) {
  switch (base) {
    case BaseFormat::luminance:
      return GL_LUMINANCE8;
    case BaseFormat::intensity:
      return GL_INTENSITY8;
    case BaseFormat::alpha:
      return GL_ALPHA8;
    case BaseFormat::rgba:
      return GL_RGBA8;
    default:
      return GL_R8;
  }
}

GLenum word_probe_format(BaseFormat base) {
  switch (base) {
    case BaseFormat::luminance:
      return GL_LUMINANCE16;
    case BaseFormat::intensity:
      return GL_INTENSITY16;
    case BaseFormat::alpha:
      return GL_ALPHA16;
    case BaseFormat::rgba:
      return GL_RGBA16;
    default:
      return GL_R16;
  }
}

GLenum upload_format(BaseFormat base) {
  switch (base) {
    case BaseFormat::luminance:
      return GL_LUMINANCE;
    case BaseFormat::alpha:
      return GL_ALPHA;
    case BaseFormat::rgba:
      return GL_RGBA;
    default:
      return GL_RED;
  }
}

}  // namespace understudy::spu
