// SPDX-License-Identifier: Apache-2.0
#include "spu/trim/restoration.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>

#include "spu/stream/event.h"
#include "spu/stream/pixels.h"

namespace understudy::spu {
namespace {

/// Appends a call with values, and with data for its last argument.
void append_call(CallId call, std::initializer_list<std::uint64_t> values, std::span<const std::byte> data,
                 Records& to) {
  to.begin(stable_id(call));
  for (const std::uint64_t value : values) to.append(value);
  to.append(0);
  to.set(values.size() + 1, to.attach(data).word());
}

void append_plain_call(CallId call, std::initializer_list<std::uint64_t> values, Records& to) {
  to.append_plain(stable_id(call), {values.begin(), values.size()});
}

struct Transfer {
  GLenum format;
  GLenum type;
};

/// A format and type that transfer the texture's values in both directions without loss; nothing if the texture
/// cannot be uploaded that way.
std::optional<Transfer> transfer_for(const DispatchTable& gl, GLuint texture) {
  const auto level = [&](GLenum name) {
    GLint value = 0;
    gl.GetTextureLevelParameteriv(texture, 0, name, &value);
    return value;
  };
  if (level(GL_TEXTURE_COMPRESSED) != 0) return std::nullopt;
  if (level(GL_TEXTURE_DEPTH_SIZE) > 0) {
    const bool floats = level(GL_TEXTURE_DEPTH_TYPE) == GL_FLOAT;
    if (level(GL_TEXTURE_STENCIL_SIZE) > 0) {
      return Transfer{GL_DEPTH_STENCIL,
                      floats ? GLenum(GL_FLOAT_32_UNSIGNED_INT_24_8_REV) : GLenum(GL_UNSIGNED_INT_24_8)};
    }
    return Transfer{GL_DEPTH_COMPONENT, floats ? GLenum(GL_FLOAT) : GLenum(GL_UNSIGNED_INT)};
  }
  constexpr std::array<std::pair<GLenum, GLenum>, 6> components = {
      {{GL_TEXTURE_RED_TYPE, GL_TEXTURE_RED_SIZE},
       {GL_TEXTURE_GREEN_TYPE, GL_TEXTURE_GREEN_SIZE},
       {GL_TEXTURE_BLUE_TYPE, GL_TEXTURE_BLUE_SIZE},
       {GL_TEXTURE_ALPHA_TYPE, GL_TEXTURE_ALPHA_SIZE},
       {GL_TEXTURE_LUMINANCE_TYPE, GL_TEXTURE_LUMINANCE_SIZE},
       {GL_TEXTURE_INTENSITY_TYPE, GL_TEXTURE_INTENSITY_SIZE}}};
  GLenum type = GL_NONE;
  GLint bits = 0;
  for (const auto& [of_type, of_size] : components) {
    if (const GLint found = level(of_type); found != GL_NONE) type = GLenum(found);
    bits = std::max(bits, level(of_size));
  }
  switch (type) {
    case GL_FLOAT:
      return Transfer{GL_RGBA, GL_FLOAT};
    case GL_INT:
      return Transfer{GL_RGBA_INTEGER, GL_INT};
    case GL_UNSIGNED_INT:
      return Transfer{GL_RGBA_INTEGER, GL_UNSIGNED_INT};
    case GL_SIGNED_NORMALIZED:
      return Transfer{GL_RGBA, bits <= 8 ? GLenum(GL_BYTE) : GLenum(GL_SHORT)};
    case GL_UNSIGNED_NORMALIZED:
      return Transfer{GL_RGBA, bits <= 8 ? GLenum(GL_UNSIGNED_BYTE) : GLenum(GL_UNSIGNED_SHORT)};
    default:
      return std::nullopt;
  }
}

std::string restore_texture(const DispatchTable& gl, GLuint here, const StreamObject& texture, Records& to) {
  if (!gl.IsTexture(here)) return {};
  const GLuint there = texture.name;
  const GLenum target = texture.target;
  if (target == GL_NONE) return fmt::format("texture {} was never bound", there);
  if (target == GL_TEXTURE_2D_MULTISAMPLE || target == GL_TEXTURE_2D_MULTISAMPLE_ARRAY)
    return fmt::format("texture {} has several samples a pixel", there);
  const auto transfer = transfer_for(gl, here);
  if (!transfer) return fmt::format("texture {} has a format that cannot be read back", there);
  for (GLint level = 0;; ++level) {
    std::array<GLint, 3> size{};
    gl.GetTextureLevelParameteriv(here, level, GL_TEXTURE_WIDTH, &size[0]);
    gl.GetTextureLevelParameteriv(here, level, GL_TEXTURE_HEIGHT, &size[1]);
    gl.GetTextureLevelParameteriv(here, level, GL_TEXTURE_DEPTH, &size[2]);
    if (size[0] <= 0 || level > 30) return {};
    if (target == GL_TEXTURE_CUBE_MAP) size[2] = 6;
    const bool flat =
        target == GL_TEXTURE_2D || target == GL_TEXTURE_RECTANGLE || target == GL_TEXTURE_1D_ARRAY;
    const ImageShape shape{size[0],          size[1],        size[2],
                           transfer->format, transfer->type, target == GL_TEXTURE_1D ? 1 : flat ? 2 : 3};
    const auto bytes = image_extent(shape, tight_pixels);
    if (!bytes) return fmt::format("texture {} is too large", there);
    std::vector<std::byte> pixels(*bytes);
    gl.GetTextureImage(here, level, transfer->format, transfer->type, GLsizei(pixels.size()), pixels.data());
    const std::uint64_t format = transfer->format;
    const std::uint64_t type = transfer->type;
    const auto at = std::uint64_t(level);
    const auto width = std::uint64_t(size[0]);
    const auto height = std::uint64_t(size[1]);
    const auto depth = std::uint64_t(size[2]);
    if (shape.dimensions == 1) {
      append_call(CallId::TextureSubImage1D, {there, at, 0, width, format, type}, pixels, to);
    } else if (shape.dimensions == 2) {
      append_call(CallId::TextureSubImage2D, {there, at, 0, 0, width, height, format, type}, pixels, to);
    } else {
      append_call(CallId::TextureSubImage3D, {there, at, 0, 0, 0, width, height, depth, format, type}, pixels,
                  to);
    }
  }
}

std::string restore_buffer(const DispatchTable& gl, GLuint here, GLuint there, Records& to) {
  if (!gl.IsBuffer(here)) return {};
  GLint size = 0;
  GLint mapped = 0;
  GLint immutable = 0;
  GLint flags = 0;
  gl.GetNamedBufferParameteriv(here, GL_BUFFER_SIZE, &size);
  gl.GetNamedBufferParameteriv(here, GL_BUFFER_MAPPED, &mapped);
  gl.GetNamedBufferParameteriv(here, GL_BUFFER_IMMUTABLE_STORAGE, &immutable);
  gl.GetNamedBufferParameteriv(here, GL_BUFFER_STORAGE_FLAGS, &flags);
  if (size <= 0) return {};
  if (mapped != 0 || (immutable != 0 && (flags & GL_DYNAMIC_STORAGE_BIT) == 0))
    return fmt::format("buffer {} cannot be written to at the cut", there);
  std::vector<std::byte> bytes(std::size_t(size), std::byte(0));
  gl.GetNamedBufferSubData(here, 0, size, bytes.data());
  append_call(CallId::NamedBufferSubData, {there, 0, std::uint64_t(size)}, bytes, to);
  return {};
}

/// While in scope, textures are read to memory as tightly packed pixels.
class TightReading {
 public:
  explicit TightReading(const DispatchTable& gl) : gl_(gl), store_(pixel_store(gl, pack_names)) {
    gl.GetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &buffer_);
    if (buffer_ != 0) gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    set_pixel_store(gl, pack_names, store_, tight_pixels);
  }
  ~TightReading() {
    set_pixel_store(gl_, pack_names, tight_pixels, store_);
    if (buffer_ != 0) gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, GLuint(buffer_));
  }
  TightReading(const TightReading&) = delete;
  TightReading& operator=(const TightReading&) = delete;

 private:
  const DispatchTable& gl_;
  const PixelStore store_;
  GLint buffer_ = 0;
};

void make_current(Player& player, const Player::PlayedContext& context, Records& to) {
  const std::array<std::uint64_t, 3> words = {context.number, std::uint64_t(context.drawable.width),
                                              std::uint64_t(context.drawable.height)};
  to.append_plain(event::current, words);
  Records now;
  now.append_plain(event::current, words);
  player.play(*record_at(now.words(), 0, now.payload()));
}

}  // namespace

std::vector<std::string> restore_drawn(Player& player, const std::map<DrawnObject, StreamObject>& drawn,
                                       Records& to) {
  std::vector<std::string> troubles;
  if (drawn.empty() || !player.prepare()) return troubles;
  const Player::PlayedContext before = player.current();
  const std::vector<Player::PlayedContext> contexts = player.contexts();
  std::uint64_t group = 0;
  const DispatchTable& gl = player.driver();
  for (auto object = drawn.begin(); object != drawn.end();) {
    group = object->first.group;
    if (player.current().group != group) {
      const auto member = std::find_if(contexts.begin(), contexts.end(), [&](const auto& context) {
        return context.group == group && context.drawable.width > 0;
      });
      if (member == contexts.end()) {
        ++object;
        continue;
      }
      make_current(player, *member, to);
    }
    GLint unpack_buffer = 0;
    gl.GetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &unpack_buffer);
    if (unpack_buffer != 0) append_plain_call(CallId::BindBuffer, {GL_PIXEL_UNPACK_BUFFER, 0}, to);
    const TightReading tight(gl);
    GLuint unpack_name = GLuint(unpack_buffer);
    for (; object != drawn.end() && object->first.group == group; ++object) {
      const auto& [what, stream] = *object;
      std::string trouble;
      if (what.kind == ObjectKind::texture) trouble = restore_texture(gl, what.here, stream, to);
      if (what.kind == ObjectKind::buffer) trouble = restore_buffer(gl, what.here, stream.name, to);
      if (what.kind == ObjectKind::buffer && what.here == GLuint(unpack_buffer)) unpack_name = stream.name;
      if (!trouble.empty()) troubles.push_back(std::move(trouble));
    }
    if (unpack_buffer != 0) append_plain_call(CallId::BindBuffer, {GL_PIXEL_UNPACK_BUFFER, unpack_name}, to);
  }
  if (player.current().number != before.number) make_current(player, before, to);
  return troubles;
}

}  // namespace understudy::spu
