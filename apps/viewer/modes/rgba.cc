// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/rgba.h"

#include <utility>

#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

std::vector<Rgba8> classify(const Texels& texels, const Table& table) {
  const std::size_t count = static_cast<std::size_t>(texels.size[0] * texels.size[1] * texels.size[2]);
  std::vector<Rgba8> colours(count);
  if (texels.format == TexelFormat::unorm8) {
    for (std::size_t i = 0; i < count; ++i) colours[i] = table[std::to_integer<std::size_t>(texels.data[i])];
  } else {
    for (std::size_t i = 0; i < count; ++i) colours[i] = look_up(table, texel_value(texels, i));
  }
  return colours;
}

class RgbaMode : public Mode {
 public:
  RgbaMode(Texels texels, std::string file) : texels_(std::move(texels)), file_(std::move(file)) {}

  void set_table(const Table& table) override {
    const std::vector<Rgba8> colours = classify(texels_, table);
    texture_ = Texture();  // freed first, so that there are never two
    texture_ = make_volume_texture(rgba_format, texels_.size, colours.data(), file_);
  }

  void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) override {
    draw_opaque_immediate(geometry, matrices);
  }

  void draw_slices(const SliceStack& stack, const Matrices& matrices) override {
    load_matrices(matrices);
    glEnable(GL_TEXTURE_3D);
    glBindTexture(GL_TEXTURE_3D, texture_.name());
    glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
    for (const Slice& slice : stack.slices) {
      glBegin(GL_TRIANGLE_FAN);
      for (std::uint32_t i = slice.first; i < slice.first + slice.count; ++i) {
        const auto& [texture, position] = stack.vertices[i];
        glTexCoord3f(texture[0], texture[1], texture[2]);
        glVertex3f(position[0], position[1], position[2]);
      }
      glEnd();
    }
    glDisable(GL_TEXTURE_3D);
  }

  std::string_view texture_format() const override { return rgba_format.name; }

 private:
  Texels texels_;
  std::string file_;
  Texture texture_;
};

}  // namespace

std::unique_ptr<Mode> make_rgba_mode(Texels texels, const std::string& file) {
  return std::make_unique<RgbaMode>(std::move(texels), file);
}

}  // namespace viewer
