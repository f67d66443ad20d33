// SPDX-License-Identifier: Apache-2.0
#include "drawing.h"

namespace understudy::spu::testing {

void look(GlApplication& app, View view, double angle, double sideways) {
  app.gl().MatrixMode(GL_PROJECTION);
  app.gl().LoadIdentity();
  if (view == View::perspective) {
    app.gl().Frustum(-0.3, 0.3, -0.3, 0.3, 1, 10);
  } else {
    app.gl().Ortho(-0.9, 0.9, -0.9, 0.9, 1, 10);
  }
  app.gl().MatrixMode(GL_MODELVIEW);
  app.gl().LoadIdentity();
  app.gl().Translated(sideways, 0, -3);
  app.gl().Rotated(angle, 0.2, 1, 0.1);
}

GLuint load_colours(GlApplication& app, bool mirrored) {
  const Blob blob;
  std::vector<std::uint8_t> field = blob.texels();
  std::vector<std::uint8_t> colours;
  if (mirrored) field.assign(field.rbegin(), field.rend());
  for (const std::uint8_t s : field) {
    const auto alpha = std::uint8_t(s * s / 255 / 5);
    if (mirrored) {
      colours.insert(colours.end(), {40, s, std::uint8_t(255 - s), alpha});
    } else {
      colours.insert(colours.end(), {s, std::uint8_t(255 - s), 90, alpha});
    }
  }
  GLuint texture = 0;
  app.gl().GenTextures(1, &texture);
  app.gl().BindTexture(GL_TEXTURE_3D, texture);
  app.gl().TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  app.gl().TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    app.gl().TexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
  app.gl().TexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, blob.x, blob.y, blob.z, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                      colours.data());
  return texture;
}

void draw_cube(GlApplication& app) {
  constexpr int slices = 40;
  app.gl().Enable(GL_BLEND);
  app.gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  app.gl().Enable(GL_TEXTURE_3D);
  app.gl().Begin(GL_QUADS);
  for (int i = 0; i < slices; ++i) {
    const double z = (i + 0.5) / slices;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      app.gl().TexCoord3d(x, y, z);
      app.gl().Vertex3d(x - 0.5, y - 0.5, z - 0.5);
    }
  }
  app.gl().End();
  app.gl().Disable(GL_TEXTURE_3D);
  app.gl().Disable(GL_BLEND);
}

void draw_square(GlApplication& app, double edge, double z, const std::array<float, 4>& colour) {
  app.gl().Begin(GL_QUADS);
  app.gl().Color4fv(colour.data());
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
    app.gl().Vertex3d(edge * x, edge * y, z);
  app.gl().Color4f(1, 1, 1, 1);
  app.gl().End();
}

}  // namespace understudy::spu::testing
