// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/table_slices.h"

#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/program.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

constexpr const char* plain_vertex_source = R"(#version 120
void main() {
  gl_TexCoord[0] = gl_MultiTexCoord0;
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)";

// Value i/255 maps to the centre of table texel i.
constexpr const char* plain_fragment_source = R"(#version 120
uniform sampler3D volume;
uniform sampler1D table;
void main() {
  float value = texture3D(volume, gl_TexCoord[0].xyz).r;
  gl_FragColor = texture1D(table, (value * 255.0 + 0.5) / 256.0);
}
)";

}  // namespace

TableSlices::TableSlices(const std::string& name, const char* vertex_source, const char* fragment_source)
    : table_(make_table_texture()),
      program_(link_program(name, vertex_source != nullptr ? vertex_source : plain_vertex_source,
                            fragment_source != nullptr ? fragment_source : plain_fragment_source)) {
  glUseProgram(program_.name());
  glUniform1i(glGetUniformLocation(program_.name(), "volume"), 0);
  glUniform1i(glGetUniformLocation(program_.name(), "table"), 1);
  glUseProgram(0);
}

void TableSlices::draw(const SliceStack& stack, const Matrices& matrices, const Texture& volume) const {
  if (stack.vertices.empty()) return;
  load_matrices(matrices);
  glUseProgram(program_.name());
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_1D, table_.name());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, volume.name());
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_TEXTURE_COORD_ARRAY);
  glVertexPointer(3, GL_FLOAT, sizeof(SliceVertex), &stack.vertices.front().position);
  glTexCoordPointer(3, GL_FLOAT, sizeof(SliceVertex), &stack.vertices.front().texture);
  for (const Slice& slice : stack.slices)
    glDrawArrays(GL_TRIANGLE_FAN, static_cast<GLint>(slice.first), static_cast<GLsizei>(slice.count));
  glDisableClientState(GL_TEXTURE_COORD_ARRAY);
  glDisableClientState(GL_VERTEX_ARRAY);
  glUseProgram(0);
}

}  // namespace viewer
