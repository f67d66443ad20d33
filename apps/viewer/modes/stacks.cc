// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/stacks.h"

#include <GL/glew.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/viewer/model/error.h"
#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/gl_objects.h"

namespace viewer {

namespace {

class StacksMode : public Mode {
 public:
  StacksMode(Texels texels, const std::string& file)
      : texels_(std::move(texels)), box_(box_of(texels_.size, texels_.spacing)) {
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    if (*std::max_element(texels_.size.begin(), texels_.size.end()) > limit)
      throw Error(ExitCode::bad_file,
                  fmt::format("{}: {} voxels along one axis are too many: textures of this OpenGL driver are "
                              "limited to {} (GL_MAX_TEXTURE_SIZE); crop or downsample the volume",
                              file, text_of(texels_.size), limit));
  }

  void set_table(const Table& table) override {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      stacks_[axis].clear();
      for (std::int64_t slice = 0; slice < texels_.size[axis]; ++slice)
        stacks_[axis].push_back(make_slice(axis, slice, table));
    }
  }

  void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) override {
    draw_opaque_immediate(geometry, matrices);
  }

  void draw_slices(const SliceStack& stack, const Matrices& matrices) override {
    load_matrices(matrices);
    const auto steeper = [&](std::size_t a, std::size_t b) {
      return std::abs(stack.normal[a]) < std::abs(stack.normal[b]);
    };
    const std::array<std::size_t, 3> axes = {0, 1, 2};
    const std::size_t axis = *std::max_element(axes.begin(), axes.end(), steeper);
    const std::vector<Texture>& slices = stacks_[axis];
    // Slices farther along the direction of view are farther from the eye.
    const bool highest_first = (stack.normal[axis] > 0) != stack.front_to_back;
    glEnable(GL_TEXTURE_2D);
    glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
    for (std::size_t i = 0; i < slices.size(); ++i) draw_slice(axis, highest_first ? slices.size() - 1 - i : i);
    glDisable(GL_TEXTURE_2D);
  }

  std::string_view texture_format() const override { return "GL_RGBA8"; }

 private:
  Texture make_slice(std::size_t axis, std::int64_t slice, const Table& table) const {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::vector<Rgba8> colours;
    std::array<std::int64_t, 3> voxel{};
    voxel[axis] = slice;
    for (voxel[v] = 0; voxel[v] < texels_.size[v]; ++voxel[v])
      for (voxel[u] = 0; voxel[u] < texels_.size[u]; ++voxel[u]) {
        const std::int64_t index = (voxel[2] * texels_.size[1] + voxel[1]) * texels_.size[0] + voxel[0];
        colours.push_back(look_up(table, texel_value(texels_, static_cast<std::size_t>(index))));
      }
    Texture texture = make_texture();
    glBindTexture(GL_TEXTURE_2D, texture.name());
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, static_cast<GLsizei>(texels_.size[u]),
                 static_cast<GLsizei>(texels_.size[v]), 0, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
    return texture;
  }

  void draw_slice(std::size_t axis, std::size_t slice) const {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    glBindTexture(GL_TEXTURE_2D, stacks_[axis][slice].name());
    glBegin(GL_QUADS);
    for (const auto& [s, t] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      Vec3 place{};
      place[axis] = (static_cast<double>(slice) + 0.5) / static_cast<double>(stacks_[axis].size());
      place[u] = s;
      place[v] = t;
      place = scale(place - Vec3{0.5, 0.5, 0.5}, box_.edges);
      glTexCoord2d(s, t);
      glVertex3dv(place.data());
    }
    glEnd();
  }

  Texels texels_;
  Box box_;
  std::array<std::vector<Texture>, 3> stacks_;
};

}  // namespace

std::unique_ptr<Mode> make_stacks_mode(Texels texels, const std::string& file) {
  return std::make_unique<StacksMode>(std::move(texels), file);
}

}  // namespace viewer
