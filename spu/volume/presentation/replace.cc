// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/presentation/replace.h"

#include <array>
#include <vector>

#include "spu/volume/context/context.h"
#include "spu/volume/context/saved_state.h"
#include "spu/volume/presentation/image_blending.h"
#include "spu/volume/presentation/own_program.h"
#include "spu/volume/refusal/refusal.h"

namespace understudy::spu {
namespace {

constexpr const char* box_vertex_source =
    "in vec4 position;\n"
    "void main() { gl_Position = position; }\n";
constexpr const char* pixel_of_image_source =
    "uniform sampler2D image;\n"
    "uniform ivec2 origin;\n"
    "uniform ivec2 extent;\n"
    "uniform vec4 otherwise;\n"
    "out vec4 colour;\n"
    "void main() {\n"
    "  ivec2 at = ivec2(gl_FragCoord.xy) - origin;\n"
    "  bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, extent));\n"
    "  colour = inside ? texelFetch(image, at, 0) : vec4(0.0);\n"
    "  if (colour == vec4(0.0)) colour = otherwise;\n"
    "}\n";

/// Capabilities that SavedState disables, and that stay as the application set them; blending is handled
/// separately.
constexpr std::array<GLenum, 5> kept_capabilities = {GL_DEPTH_TEST, GL_SCISSOR_TEST, GL_CULL_FACE,
                                                     GL_MULTISAMPLE, GL_DITHER};

}  // namespace

bool Replacer::prepare() {
  if (program_ != 0) return true;
  const DispatchTable& gl = *context_.gl;
  program_ = link_program(context_, box_vertex_source, pixel_of_image_source);
  if (program_ == 0) return false;
  origin_ = gl.GetUniformLocation(program_, "origin");
  extent_ = gl.GetUniformLocation(program_, "extent");
  otherwise_ = gl.GetUniformLocation(program_, "otherwise");
  gl.GenTextures(1, &texture_);
  gl.GenBuffers(1, &vertices_);
  gl.GenVertexArrays(1, &vertex_array_);
  return true;
}

void Replacer::show(const volume::ImageView& image, const volume::Rgba& otherwise) const {
  const DispatchTable& gl = *context_.gl;
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, texture_);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  constexpr std::array<float, 4> nothing{};
  const bool empty = image.rect.empty();
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, empty ? 1 : image.rect.width, empty ? 1 : image.rect.height, 0,
                GL_RGBA, GL_FLOAT, empty ? nothing.data() : image.rgba.data());
  gl.UseProgram(program_);
  gl.Uniform4fv(otherwise_, 1, otherwise.data());
  gl.Uniform2i(origin_, image.rect.x, image.rect.y);
  gl.Uniform2i(extent_, empty ? 0 : image.rect.width, empty ? 0 : image.rect.height);
}

void Replacer::draw(const ObservedPolygons& box) const {
  const DispatchTable& gl = *context_.gl;
  std::vector<std::array<float, 4>> positions;
  positions.reserve(box.vertices.size());
  for (const ObservedVertex& vertex : box.vertices) {
    const auto& clip = vertex.clip;
    positions.push_back({float(clip[0]), float(clip[1]), float(clip[2]), float(clip[3])});
  }
  gl.BindVertexArray(vertex_array_);
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_);
  gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(positions.size() * sizeof(positions[0])), positions.data(),
                GL_STREAM_DRAW);
  gl.VertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, nullptr);
  gl.EnableVertexAttribArray(0);
  gl.DrawArrays(GL_TRIANGLES, 0, GLsizei(positions.size()));
}

void Replacer::draw_once_more(const volume::ImageView& image, const volume::Rgba& otherwise,
                              const ObservedPolygons& box, std::optional<volume::Operator> blended,
                              bool alpha) {
  const DispatchTable& gl = *context_.gl;
  std::array<GLboolean, 4> mask{};
  GLboolean depth_mask = GL_FALSE;
  gl.GetBooleanv(GL_COLOR_WRITEMASK, mask.data());
  gl.GetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask);
  SavedState saved(context_);
  if (!prepare()) throw Refusal{"the driver does not link the program that images are drawn with"};
  saved.borrow_texture(GL_TEXTURE_2D, 0);
  show(image, otherwise);
  for (const GLenum capability : kept_capabilities) {
    if (saved.was_enabled(capability)) gl.Enable(capability);
  }
  if (blended) {
    gl.Enable(GL_BLEND);
    set_image_blending(gl, *blended);
  }
  gl.ColorMask(mask[0], mask[1], mask[2], alpha ? mask[3] : GLboolean(GL_FALSE));
  // Blended fragments leave the depth to DepthWatch.
  gl.DepthMask(blended ? GLboolean(GL_FALSE) : depth_mask);
  draw(box);
}

void Replacer::replace(const volume::ImageView& image, const volume::Rgba& otherwise,
                       const ObservedPolygons& box) {
  draw_once_more(image, otherwise, box, std::nullopt, true);
}

void Replacer::blend(const volume::ImageView& image, volume::Operator op, bool alpha,
                     const ObservedPolygons& box) {
  draw_once_more(image, {}, box, op, alpha);
}

}  // namespace understudy::spu
