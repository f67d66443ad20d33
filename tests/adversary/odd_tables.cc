// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/odd_tables.h"

#include "tests/adversary/textures.h"

namespace adversary {
namespace {

constexpr int place = 5;            ///< texture unit or binding
constexpr int table_entries = 256;  ///< of a table

GLenum target_of(TableKind kind) {
  switch (kind) {
    case TableKind::array_1d:
      return GL_TEXTURE_1D_ARRAY;
    case TableKind::array_2d:
      return GL_TEXTURE_2D_ARRAY;
    case TableKind::rectangle:
      return GL_TEXTURE_RECTANGLE;
    case TableKind::buffer_texture:
      return GL_TEXTURE_BUFFER;
    case TableKind::uniform_block:
      return GL_UNIFORM_BUFFER;
    case TableKind::storage_block:
      return GL_SHADER_STORAGE_BUFFER;
    default:
      return GL_NONE;
  }
}

bool lies_in_a_buffer(TableKind kind) {
  return kind == TableKind::buffer_texture || kind == TableKind::uniform_block ||
         kind == TableKind::storage_block;
}

}  // namespace

std::string table_declarations(TableKind kind) {
  const std::string entry = "entries[int(clamp(value, 0.0, 1.0) * 255.0 + 0.5)]";
  const auto function = [](const std::string& expression) {
    return "\nvec4 looked_up(float value) { return " + expression + "; }\n";
  };
  switch (kind) {
    case TableKind::array_1d:
      return "uniform sampler1DArray odd;" + function("texture(odd, vec2(value, 1.0))");
    case TableKind::array_2d:
      return "uniform sampler2DArray odd;" + function("texture(odd, vec3(value, 0.5, 1.0))");
    case TableKind::rectangle:
      return "uniform sampler2DRect odd;" + function("texture(odd, vec2(value * 255.0 + 0.5, 0.5))");
    case TableKind::buffer_texture:
      return "uniform samplerBuffer odd;" +
             function("texelFetch(odd, int(clamp(value, 0.0, 1.0) * 255.0 + 0.5))");
    case TableKind::uniform_block:
      return "layout(std140) uniform Table { vec4 entries[256]; };" + function(entry);
    case TableKind::storage_block:
      return "layout(std430, binding = 5) readonly buffer Table { vec4 entries[]; };" + function(entry);
    default:
      return "uniform vec4 entries[256];" + function(entry);
  }
}

std::string at_version(int version, std::string shader) {
  return shader.replace(shader.find("330"), 3, std::to_string(version));
}

OddTable::OddTable(const Canvas& canvas, TableKind kind, const GlslProgram& program,
                   const std::vector<Colour>& colours)
    : gl_(canvas.gl), kind_(kind), program_(program), target_(target_of(kind)) {
  program_.use();
  program_.set("odd", place);
  gl_.ActiveTexture(GL_TEXTURE0 + place);
  if (kind_ != TableKind::uniform_array) create();
  if (kind_ == TableKind::array_1d || kind_ == TableKind::array_2d || kind_ == TableKind::rectangle)
    filter_linearly(canvas, target_);
  edit(colours);
}

void OddTable::create() {
  constexpr GLsizeiptr bytes = sizeof(float) * 4 * table_entries;
  if (lies_in_a_buffer(kind_)) {
    gl_.GenBuffers(1, &buffer_);
    gl_.BindBuffer(target_, buffer_);
    gl_.BufferData(target_, bytes, nullptr, GL_DYNAMIC_DRAW);
    if (kind_ != TableKind::buffer_texture) gl_.BindBufferBase(target_, place, buffer_);
    if (kind_ == TableKind::uniform_block)
      gl_.UniformBlockBinding(program_.name(), gl_.GetUniformBlockIndex(program_.name(), "Table"), place);
  }
  if (kind_ == TableKind::uniform_block || kind_ == TableKind::storage_block) return;
  gl_.GenTextures(1, &texture_);
  gl_.BindTexture(target_, texture_);
  switch (kind_) {
    case TableKind::array_2d:
      return gl_.TexImage3D(target_, 0, GL_RGBA8, table_entries, 1, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    case TableKind::buffer_texture:
      return gl_.TexBuffer(target_, GL_RGBA32F, buffer_);
    default:
      return gl_.TexImage2D(target_, 0, GL_RGBA8, table_entries, kind_ == TableKind::array_1d ? 2 : 1, 0,
                            GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  }
}

void OddTable::edit(const std::vector<Colour>& colours) const {
  const std::vector<float> floats = as_floats(colours);
  if (kind_ == TableKind::uniform_array) {
    program_.use();
    return gl_.Uniform4fv(program_.location("entries"), table_entries, floats.data());
  }
  if (lies_in_a_buffer(kind_)) {
    gl_.BindBuffer(target_, buffer_);
    return gl_.BufferSubData(target_, 0, static_cast<GLsizeiptr>(floats.size() * sizeof(float)), floats.data());
  }
  gl_.ActiveTexture(GL_TEXTURE0 + place);
  if (kind_ == TableKind::array_2d)
    gl_.TexSubImage3D(target_, 0, 0, 0, 1, table_entries, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
  else
    gl_.TexSubImage2D(target_, 0, 0, kind_ == TableKind::array_1d ? 1 : 0, table_entries, 1, GL_RGBA,
                      GL_UNSIGNED_BYTE, colours.data());
}

}  // namespace adversary
