// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/extent.h"

#include <cstring>
#include <string_view>

#include "spu/stream/pixels.h"

namespace understudy::spu {
namespace {

/// The number of values of a parameter of glTexParameter, glLight, glFog and similar commands.
std::size_t values_of(GLenum name) {
  switch (name) {
    case GL_AMBIENT:
    case GL_DIFFUSE:
    case GL_SPECULAR:
    case GL_EMISSION:
    case GL_AMBIENT_AND_DIFFUSE:
    case GL_POSITION:
    case GL_LIGHT_MODEL_AMBIENT:
    case GL_FOG_COLOR:
    case GL_TEXTURE_ENV_COLOR:
    case GL_TEXTURE_BORDER_COLOR:
    case GL_TEXTURE_SWIZZLE_RGBA:
    case GL_OBJECT_PLANE:
    case GL_EYE_PLANE:
    case GL_PATCH_DEFAULT_OUTER_LEVEL:
    case GL_COLOR_TABLE_SCALE:
    case GL_COLOR_TABLE_BIAS:
    case GL_CONVOLUTION_FILTER_SCALE:
    case GL_CONVOLUTION_FILTER_BIAS:
    case GL_CONVOLUTION_BORDER_COLOR:
    case GL_CONSTANT_COLOR0_NV:
    case GL_CONSTANT_COLOR1_NV:
      return 4;
    case GL_SPOT_DIRECTION:
    case GL_COLOR_INDEXES:
    case GL_POINT_DISTANCE_ATTENUATION:
      return 3;
    case GL_PATCH_DEFAULT_INNER_LEVEL:
      return 2;
    default:
      return 1;
  }
}

std::optional<std::size_t> list_name_size(GLenum type) {
  switch (type) {
    case GL_BYTE:
    case GL_UNSIGNED_BYTE:
      return 1;
    case GL_SHORT:
    case GL_UNSIGNED_SHORT:
    case GL_2_BYTES:
      return 2;
    case GL_3_BYTES:
      return 3;
    case GL_INT:
    case GL_UNSIGNED_INT:
    case GL_FLOAT:
    case GL_4_BYTES:
      return 4;
    default:
      return std::nullopt;
  }
}

/// The number of values per control point.
std::optional<std::size_t> map_components(GLenum target) {
  switch (target) {
    case GL_MAP1_INDEX:
    case GL_MAP1_TEXTURE_COORD_1:
    case GL_MAP2_INDEX:
    case GL_MAP2_TEXTURE_COORD_1:
      return 1;
    case GL_MAP1_TEXTURE_COORD_2:
    case GL_MAP2_TEXTURE_COORD_2:
      return 2;
    case GL_MAP1_NORMAL:
    case GL_MAP1_TEXTURE_COORD_3:
    case GL_MAP1_VERTEX_3:
    case GL_MAP2_NORMAL:
    case GL_MAP2_TEXTURE_COORD_3:
    case GL_MAP2_VERTEX_3:
      return 3;
    case GL_MAP1_COLOR_4:
    case GL_MAP1_TEXTURE_COORD_4:
    case GL_MAP1_VERTEX_4:
    case GL_MAP2_COLOR_4:
    case GL_MAP2_TEXTURE_COORD_4:
    case GL_MAP2_VERTEX_4:
      return 4;
    default:
      return std::nullopt;
  }
}

/// Larger counts are invalid; this keeps all products below within 64 bits.
constexpr std::int64_t most_values = std::int64_t(1) << 40;

/// glMap1(target, u1, u2, stride, order, points), glMap2(target, u1, u2, ustride, uorder, v1, v2, vstride,
/// vorder, ...).
std::optional<std::size_t> map_points(const CallShape& shape, const std::uint64_t* words, std::size_t value) {
  const auto components = map_components(GLenum(words[0]));
  if (!components) return std::nullopt;
  std::int64_t values = std::int64_t(*components);
  const bool surface = shape.parameter_count > 6;
  for (std::size_t direction = 0; direction < (surface ? 2U : 1U); ++direction) {
    const auto stride = std::int64_t(std::int32_t(words[3 + 4 * direction]));
    const auto order = std::int64_t(std::int32_t(words[4 + 4 * direction]));
    // OpenGL rejects these, and orders above GL_MAX_EVAL_ORDER, which is a few dozen, without reading a point.
    if (order < 1 || order > 64 || stride < std::int64_t(*components)) return 0;
    values += (order - 1) * stride;
  }
  return std::size_t(values) * value;
}

/// The bytes that glDraw*Indirect reads. If a buffer contains the number of draws, the call specifies their
/// maximum.
std::size_t indirect_bytes(const CallShape& shape, const std::uint64_t* words) {
  const bool elements = shape.parameter_count > 2 && std::string_view(shape.parameters()[1].name()) == "type";
  const std::size_t one = elements ? 20 : 16;
  std::int64_t draws = 1;
  std::int64_t stride = 0;
  for (std::size_t p = 0; p < shape.parameter_count; ++p) {
    const std::string_view name = shape.parameters()[p].name();
    const bool number = shape.parameters()[p].type == ValueType::int32;
    if (number && (name == "drawcount" || name == "primcount" || name == "maxdrawcount"))
      draws = std::int32_t(words[p]);
    if (name == "stride") stride = std::int32_t(words[p]);
  }
  if (draws < 1 || stride < 0) return 0;
  return std::size_t(draws - 1) * (stride != 0 ? std::size_t(stride) : one) + one;
}

/// The value of the argument that a rule counts by, in the type that OpenGL sees; 1 without such an argument.
std::int64_t counted_by(const CallShape& shape, const ParameterShape& pointer, const std::uint64_t* words) {
  if (pointer.counted_by == no_argument) return 1;
  const std::uint64_t word = words[pointer.counted_by];
  switch (shape.parameters()[pointer.counted_by].type) {
    case ValueType::int32:
      return std::int32_t(word);
    case ValueType::uint32:
    case ValueType::enumeration:
      return std::uint32_t(word);
    default:
      return std::int64_t(word);
  }
}

}  // namespace

std::uint8_t argument_named(const CallShape& shape, std::string_view name) noexcept {
  for (std::uint8_t p = 0; p < shape.parameter_count; ++p) {
    if (name == shape.parameters()[p].name()) return p;
  }
  return no_argument;
}

ImageShape image_shape(CallId call, const std::uint64_t* words) {
  const ImageArguments& image = call_shape(call).image;
  const auto size = [&](std::uint8_t argument, GLsizei otherwise) {
    return argument == no_argument ? otherwise : GLsizei(words[argument]);
  };
  ImageShape shape;
  // glPolygonStipple has no size arguments: its image is always 32 by 32 bits. glBitmap has only a size.
  const GLsizei otherwise = image.width == no_argument ? 32 : 1;
  shape.width = size(image.width, otherwise);
  shape.height = size(image.height, otherwise);
  shape.depth = size(image.depth, 1);
  const bool bits = image.format == no_argument;
  shape.format = bits ? GL_COLOR_INDEX : GLenum(words[image.format]);
  shape.type = bits ? GL_BITMAP : GLenum(words[image.type]);
  shape.dimensions = image.depth != no_argument ? 3 : image.height != no_argument || bits ? 2 : 1;
  return shape;
}

std::size_t component_size(GLenum type) noexcept {
  switch (type) {
    case GL_BYTE:
    case GL_UNSIGNED_BYTE:
      return 1;
    case GL_SHORT:
    case GL_UNSIGNED_SHORT:
    case GL_HALF_FLOAT:
      return 2;
    case GL_INT:
    case GL_UNSIGNED_INT:
    case GL_FLOAT:
    case GL_FIXED:
      return 4;
    case GL_DOUBLE:
    case GL_INT64_ARB:
    case GL_UNSIGNED_INT64_ARB:
      return 8;
    default:
      return 0;
  }
}

bool tells_by_enumerant(ExtentRule rule) noexcept {
  return rule == ExtentRule::image || rule == ExtentRule::one_texel || rule == ExtentRule::list_names ||
         rule == ExtentRule::map_points || rule == ExtentRule::indices;
}

std::optional<std::size_t> least_pointee_bytes(CallId call, std::size_t parameter, const std::uint64_t* words) {
  const CallShape& shape = call_shape(call);
  const ParameterShape& pointer = shape.parameters()[parameter];
  const bool text = pointer.rule == ExtentRule::text ||
                    (pointer.rule == ExtentRule::text_or_counted && counted_by(shape, pointer, words) < 0);
  return text ? 1 : pointee_bytes(call, parameter, words);
}

namespace {

/// The type of indices is the first enumerant after their number.
std::optional<std::size_t> index_bytes(const CallShape& shape, const ParameterShape& pointer,
                                       std::int64_t count, const std::uint64_t* words) {
  for (std::size_t p = 0; p < shape.parameter_count; ++p) {
    if (p > pointer.counted_by && shape.parameters()[p].type == ValueType::enumeration)
      return std::size_t(count > 0 ? count : 0) * component_size(GLenum(words[p]));
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::size_t> pointee_bytes(CallId call, std::size_t parameter, const std::uint64_t* words) {
  const CallShape& shape = call_shape(call);
  const ParameterShape& pointer = shape.parameters()[parameter];
  const std::size_t value = pointer.pointer > 1 ? sizeof(void*) : value_size(pointer.type);
  const std::int64_t count = counted_by(shape, pointer, words);
  const auto* text = reinterpret_cast<const char*>(static_cast<std::uintptr_t>(words[parameter]));
  switch (pointer.rule) {
    case ExtentRule::counted:
    case ExtentRule::counted_or_unpack:
    case ExtentRule::retained:
    case ExtentRule::texts:
      if (count > most_values) return std::nullopt;
      return std::size_t(count > 0 ? count : 0) * pointer.factor * value / pointer.divisor;
    case ExtentRule::text:
      return std::strlen(text) + 1;
    case ExtentRule::text_or_counted:
      return count < 0 ? std::strlen(text) + 1 : std::size_t(count);
    case ExtentRule::parameter_values:
      return (pointer.counted_by == no_argument ? 1 : values_of(GLenum(count))) * value;
    case ExtentRule::one_texel:
      return pixel_bytes(GLenum(words[shape.image.format]), GLenum(words[shape.image.type]));
    case ExtentRule::clear_value:
      return (GLenum(count) == GL_COLOR ? 4 : 1) * value;
    case ExtentRule::indices:
      return index_bytes(shape, pointer, count, words);
    case ExtentRule::list_names: {
      const auto size = list_name_size(GLenum(words[1]));
      if (!size) return std::nullopt;
      return std::size_t(count > 0 ? count : 0) * *size;
    }
    case ExtentRule::indirect:
      return indirect_bytes(shape, words);
    case ExtentRule::map_points:
      return map_points(shape, words, value);
    default:
      return std::nullopt;
  }
}

}  // namespace understudy::spu
