#include "apps/viewer/modes/table.h"

#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/program.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

constexpr const char* vertex_source = R"(#version 120
void main() {
  gl_TexCoord[0] = gl_MultiTexCoord0;
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)";

// Value i/255 falls on the centre of table texel i.
constexpr const char* fragment_source = R"(#version 120
uniform sampler3D volume;
uniform sampler1D table;
void main() {
  float value = texture3D(volume, gl_TexCoord[0].xyz).r;
  gl_FragColor = texture1D(table, (value * 255.0 + 0.5) / 256.0);
}
)";

class TableMode : public Mode {
 public:
  TableMode(const Texels& texels, const std::string& file)
      : format_(luminance_format(texels.format)),
        volume_(make_volume_texture(format_, texels.size, texels.data.data(), file)),
        table_(make_table_texture()),
        program_(link_program("table", vertex_source, fragment_source)) {
    glUseProgram(program_.name());
    glUniform1i(glGetUniformLocation(program_.name(), "volume"), 0);
    glUniform1i(glGetUniformLocation(program_.name(), "table"), 1);
    glUseProgram(0);
  }

  void set_table(const Table& table) override { upload_table(table_, table); }

  void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) override {
    draw_opaque_immediate(geometry, matrices);
  }

  void draw_slices(const SliceStack& stack, const Matrices& matrices) override {
    if (stack.vertices.empty()) return;
    load_matrices(matrices);
    glUseProgram(program_.name());
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_1D, table_.name());
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_3D, volume_.name());
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

  std::string_view texture_format() const override { return format_.name; }

 private:
  VolumeTextureFormat format_;
  Texture volume_;
  Texture table_;
  Program program_;
};

}  // namespace

std::unique_ptr<Mode> make_table_mode(const Texels& texels, const std::string& file) {
  return std::make_unique<TableMode>(texels, file);
}

}  // namespace viewer
