#include "spu/volume/present.h"

#include <string>

#include "spu/volume/saved_state.h"

namespace understudy::spu {
namespace {

constexpr const char* vertex_source =
    "void main() {\n"
    "  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
    "  gl_Position = vec4(corner, 0.0, 1.0);\n"
    "}\n";
constexpr const char* fragment_source =
    "uniform sampler2D picture;\n"
    "uniform ivec2 origin;\n"
    "out vec4 colour;\n"
    "uniform bool first_as_alpha;\n"
    "void main() {\n"
    "  colour = texelFetch(picture, ivec2(gl_FragCoord.xy) - origin, 0);\n"
    "  if (first_as_alpha) colour.a = colour.r;\n"
    "}\n";

GLuint compile(const DispatchTable& gl, GLenum stage, bool core, const char* source) {
  const std::string text = std::string(core ? "#version 150\n" : "#version 130\n") + source;
  const char* pointer = text.c_str();
  const GLuint shader = gl.CreateShader(stage);
  gl.ShaderSource(shader, 1, &pointer, nullptr);
  gl.CompileShader(shader);
  return shader;
}

}  // namespace

bool Presenter::prepare() {
  if (program_ != 0) return true;
  const DispatchTable& gl = *context_.gl;
  const GLuint vertex = compile(gl, GL_VERTEX_SHADER, context_.core, vertex_source);
  const GLuint fragment = compile(gl, GL_FRAGMENT_SHADER, context_.core, fragment_source);
  program_ = gl.CreateProgram();
  gl.AttachShader(program_, vertex);
  gl.AttachShader(program_, fragment);
  gl.DeleteShader(vertex);
  gl.DeleteShader(fragment);
  gl.LinkProgram(program_);
  GLint linked = 0;
  gl.GetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (!linked) {
    gl.DeleteProgram(program_);
    program_ = 0;
    return false;
  }
  origin_ = gl.GetUniformLocation(program_, "origin");
  first_as_alpha_ = gl.GetUniformLocation(program_, "first_as_alpha");
  gl.GenTextures(1, &texture_);
  gl.GenVertexArrays(1, &vertex_array_);
  return true;
}

void Presenter::draw(const volume::ImageView& image) const {
  const DispatchTable& gl = *context_.gl;
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, image.rect.width, image.rect.height, 0, GL_RGBA, GL_FLOAT,
                image.rgba.data());
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

void Presenter::present(const volume::ImageView& image, AlphaResult result, const volume::ImageView* alpha) {
  if (image.rect.empty()) return;
  const DispatchTable& gl = *context_.gl;
  // The application's scissor and colour mask hold for its slices, so they hold for the picture.
  const GLboolean scissor = gl.IsEnabled(GL_SCISSOR_TEST);
  std::array<GLboolean, 4> mask{};
  gl.GetBooleanv(GL_COLOR_WRITEMASK, mask.data());
  SavedState saved(context_);
  if (!prepare()) return;
  saved.borrow_texture(GL_TEXTURE_2D, 0);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, texture_);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.UseProgram(program_);
  gl.Uniform2i(origin_, image.rect.x, image.rect.y);
  gl.Uniform1i(first_as_alpha_, 0);
  gl.BindVertexArray(vertex_array_);
  // The viewport is the rectangle: exactly its pixels are shaded.
  gl.Viewport(image.rect.x, image.rect.y, image.rect.width, image.rect.height);
  if (scissor) gl.Enable(GL_SCISSOR_TEST);
  const bool over_alpha = mask[3] && result == AlphaResult::coverage;
  gl.ColorMask(mask[0], mask[1], mask[2], over_alpha);
  gl.Enable(GL_BLEND);
  gl.BlendEquation(GL_FUNC_ADD);
  gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  draw(image);
  if (!mask[3] || result != AlphaResult::squared_sum || alpha == nullptr) return;
  // Alpha becomes sum + T * alpha; the blend unit has one source alpha, so: first the product, then the sum.
  gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
  gl.BlendFunc(GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
  gl.Uniform1i(first_as_alpha_, 1);
  gl.BlendFunc(GL_ONE, GL_ONE);
  draw(*alpha);
}

}  // namespace understudy::spu
