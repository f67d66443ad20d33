// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/core.h"

#include <cstddef>

#include "apps/viewer/modes/program.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

constexpr const char* slice_vertex_source = R"(#version 330 core
uniform mat4 modelview_projection;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 texture_coordinate;
out vec3 coordinate;
void main() {
  coordinate = texture_coordinate;
  gl_Position = modelview_projection * vec4(position, 1.0);
}
)";

// Value i/255 maps to the centre of table texel i.
constexpr const char* slice_fragment_source = R"(#version 330 core
uniform sampler3D volume;
uniform sampler1D table;
in vec3 coordinate;
out vec4 colour;
void main() {
  float value = texture(volume, coordinate).r;
  colour = texture(table, (value * 255.0 + 0.5) / 256.0);
}
)";

constexpr const char* opaque_vertex_source = R"(#version 330 core
uniform mat4 modelview_projection;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 vertex_colour;
out vec3 solid_colour;
void main() {
  solid_colour = vertex_colour;
  gl_Position = modelview_projection * vec4(position, 1.0);
}
)";

constexpr const char* opaque_fragment_source = R"(#version 330 core
in vec3 solid_colour;
out vec4 colour;
void main() { colour = vec4(solid_colour, 1.0); }
)";

// A vertex buffer that is refilled for every draw: two vec3 per vertex.
class Stream {
 public:
  Stream(std::size_t stride, std::size_t first_offset, std::size_t second_offset)
      : array_(make_vertex_array()), buffer_(make_buffer()) {
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
    const auto attribute = [&](GLuint location, std::size_t offset) {
      glEnableVertexAttribArray(location);
      glVertexAttribPointer(location, 3, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                            reinterpret_cast<const void*>(offset));
    };
    attribute(0, first_offset);
    attribute(1, second_offset);
    glBindVertexArray(0);
  }

  template <typename Vertex>
  void draw(GLenum primitive, const std::vector<Vertex>& vertices) const {
    if (vertices.empty()) return;
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(),
                 GL_STREAM_DRAW);
    glDrawArrays(primitive, 0, static_cast<GLsizei>(vertices.size()));
    glBindVertexArray(0);
  }

 private:
  VertexArray array_;
  Buffer buffer_;
};

// Makes one list of triangles for all slices, so that one call draws them.
std::vector<SliceVertex> triangles_of(const SliceStack& stack) {
  std::vector<SliceVertex> triangles;
  triangles.reserve(stack.vertices.size() * 3);
  for (const Slice& slice : stack.slices) {
    const SliceVertex* fan = &stack.vertices[slice.first];
    for (std::uint32_t i = 1; i + 1 < slice.count; ++i)
      triangles.insert(triangles.end(), {fan[0], fan[i], fan[i + 1]});
  }
  return triangles;
}

void use_with_matrices(const Program& program, const Matrices& matrices) {
  glUseProgram(program.name());
  glUniformMatrix4fv(glGetUniformLocation(program.name(), "modelview_projection"), 1, GL_FALSE,
                     to_float(matrices.projection * matrices.modelview).data());
}

class CoreMode : public Mode {
 public:
  CoreMode(const Texels& texels, const std::string& file)
      : format_(red_format(texels.format)),
        volume_(make_volume_texture(format_, texels.size, texels.data.data(), file)),
        table_(make_table_texture()),
        slice_program_(link_program("slice", slice_vertex_source, slice_fragment_source)),
        opaque_program_(link_program("frame and axes", opaque_vertex_source, opaque_fragment_source)),
        slices_(sizeof(SliceVertex), offsetof(SliceVertex, position), offsetof(SliceVertex, texture)),
        opaque_(sizeof(ColouredVertex), offsetof(ColouredVertex, position), offsetof(ColouredVertex, colour)) {
    glUseProgram(slice_program_.name());
    glUniform1i(glGetUniformLocation(slice_program_.name(), "volume"), 0);
    glUniform1i(glGetUniformLocation(slice_program_.name(), "table"), 1);
    glUseProgram(0);
  }

  void set_table(const Table& table) override { upload_table(table_, table); }

  void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) override {
    use_with_matrices(opaque_program_, matrices);
    opaque_.draw(GL_LINES, geometry.lines);
    opaque_.draw(GL_TRIANGLES, geometry.triangles);
    glUseProgram(0);
  }

  void draw_slices(const SliceStack& stack, const Matrices& matrices) override {
    use_with_matrices(slice_program_, matrices);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_1D, table_.name());
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_3D, volume_.name());
    slices_.draw(GL_TRIANGLES, triangles_of(stack));
    glUseProgram(0);
  }

  std::string_view texture_format() const override { return format_.name; }

 private:
  VolumeTextureFormat format_;
  Texture volume_;
  Texture table_;
  Program slice_program_;
  Program opaque_program_;
  Stream slices_;
  Stream opaque_;
};

}  // namespace

std::unique_ptr<Mode> make_core_mode(const Texels& texels, const std::string& file) {
  return std::make_unique<CoreMode>(texels, file);
}

}  // namespace viewer
