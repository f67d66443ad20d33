// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/geometry/given_vertices.h"

#include <array>
#include <span>

#include "spu/state_value.h"
#include "spu/volume/geometry/transform_feedback.h"

namespace understudy::spu {
namespace {

// In the order of GL_T4F_C4F_N3F_V4F. The fixed-function pipeline computes position, colour and the coordinate
// of texture unit 0 from these alone.
constexpr std::array<const char*, 4> captured_attributes = {"coordinate", "colour", "normal", "vertex"};
constexpr std::size_t floats_per_given_vertex = 15;
constexpr const char* attribute_shader =
    "#version 120\n"
    "varying vec4 coordinate;\n"
    "varying vec4 colour;\n"
    "varying vec3 normal;\n"
    "varying vec4 vertex;\n"
    "void main() {\n"
    "  coordinate = gl_MultiTexCoord0;\n"
    "  colour = gl_Color;\n"
    "  normal = gl_Normal;\n"
    "  vertex = gl_Vertex;\n"
    "  gl_Position = gl_Vertex;\n"
    "}\n";

/// In its scope, `data` is the only vertex array; the destructor restores arrays and current attributes.
class ArraysInMemory {
 public:
  ArraysInMemory(const GlContext& context, std::span<const float> data) : gl_(*context.gl) {
    gl_.GetFloatv(GL_CURRENT_COLOR, colour_.data());
    gl_.GetFloatv(GL_CURRENT_NORMAL, normal_.data());
    active_ = state_value(gl_, GL_ACTIVE_TEXTURE);
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.GetFloatv(GL_CURRENT_TEXTURE_COORDS, coordinate_.data());
    gl_.ActiveTexture(GLenum(active_));
    vertex_array_ = state_value(gl_, GL_VERTEX_ARRAY_BINDING);
    array_buffer_ = state_value(gl_, GL_ARRAY_BUFFER_BINDING);
    // Only the default vertex array object may have arrays in memory.
    gl_.BindVertexArray(0);
    gl_.PushClientAttrib(GL_CLIENT_VERTEX_ARRAY_BIT);
    gl_.BindBuffer(GL_ARRAY_BUFFER, 0);
    for (int unit = context.fixed_function_units - 1; unit >= 0; --unit) {
      gl_.ClientActiveTexture(GLenum(GL_TEXTURE0 + unit));
      gl_.DisableClientState(GL_TEXTURE_COORD_ARRAY);
    }
    const GLint attributes = state_value(gl_, GL_MAX_VERTEX_ATTRIBS);
    for (GLint i = 0; i < attributes; ++i) gl_.DisableVertexAttribArray(GLuint(i));
    gl_.InterleavedArrays(GL_T4F_C4F_N3F_V4F, 0, data.data());
  }
  ~ArraysInMemory() {
    gl_.PopClientAttrib();
    gl_.BindVertexArray(GLuint(vertex_array_));
    gl_.BindBuffer(GL_ARRAY_BUFFER, GLuint(array_buffer_));
    gl_.Color4fv(colour_.data());
    gl_.Normal3fv(normal_.data());
    gl_.MultiTexCoord4fv(GL_TEXTURE0, coordinate_.data());
  }
  ArraysInMemory(const ArraysInMemory&) = delete;
  ArraysInMemory& operator=(const ArraysInMemory&) = delete;

 private:
  const DispatchTable& gl_;
  std::array<GLfloat, 4> colour_{};
  std::array<GLfloat, 4> normal_{};
  std::array<GLfloat, 4> coordinate_{};
  GLint active_ = 0;
  GLint vertex_array_ = 0;
  GLint array_buffer_ = 0;
};

}  // namespace

bool GivenVertices::can_tell(const Run& run) const {
  const DispatchTable& gl = *context_.gl;
  if (!run.only_polygons) return false;
  // A vertex program may read any attribute.
  if (context_.vertex_assembly && gl.IsEnabled(GL_VERTEX_PROGRAM_ARB)) return false;
  return state_value(gl, GL_CLIENT_ATTRIB_STACK_DEPTH) < state_value(gl, GL_MAX_CLIENT_ATTRIB_STACK_DEPTH);
}

bool GivenVertices::prepare() {
  if (program_ != 0 || has_failed_) return program_ != 0;
  const DispatchTable& gl = *context_.gl;
  const GLuint shader = gl.CreateShader(GL_VERTEX_SHADER);
  gl.ShaderSource(shader, 1, &attribute_shader, nullptr);
  gl.CompileShader(shader);
  const GLuint program = gl.CreateProgram();
  gl.AttachShader(program, shader);
  gl.DeleteShader(shader);
  gl.TransformFeedbackVaryings(program, GLsizei(captured_attributes.size()), captured_attributes.data(),
                               GL_INTERLEAVED_ATTRIBS);
  gl.LinkProgram(program);
  GLint linked = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked) {
    program_ = program;
  } else {
    gl.DeleteProgram(program);
    has_failed_ = true;
  }
  return linked;
}

std::vector<float> GivenVertices::read(const Run& run) {
  const std::size_t slices = run.pipeline().stack ? run.slices_drawn_alike() : 1;
  if (slices == 0 || !can_tell(run) || !prepare()) return {};
  std::vector<float> vertices = TransformFeedback(context_, program_).triangles(run, floats_per_given_vertex);
  if (vertices.size() % (3 * slices * floats_per_given_vertex) != 0) return {};
  return vertices;
}

void GivenVertices::draw(const Run& run, const std::vector<float>& vertices) const {
  const DispatchTable& gl = *context_.gl;
  const ArraysInMemory arrays(context_, vertices);
  const std::size_t slices = run.pipeline().stack ? run.slices_drawn_alike() : 1;
  const std::size_t of_slice = vertices.size() / floats_per_given_vertex / slices;
  for (std::size_t slice = 0; slice < slices; ++slice) {
    if (run.pipeline().stack) gl.PassThrough(GLfloat(slice));
    gl.DrawArrays(GL_TRIANGLES, GLint(slice * of_slice), GLsizei(of_slice));
  }
}

}  // namespace understudy::spu
