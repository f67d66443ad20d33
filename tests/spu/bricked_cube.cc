// SPDX-License-Identifier: Apache-2.0
#include "bricked_cube.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "drawing.h"
#include "glsl_program.h"

namespace understudy::spu::testing {
namespace {

constexpr int slices = 40;

constexpr const char* vertices =
    "#version 120\n"
    "varying vec3 place;\n"
    "void main() { place = gl_MultiTexCoord0.xyz; gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex; }\n";
std::vector<std::uint8_t> colours_of_blob() {
  std::vector<std::uint8_t> colours;
  for (const std::uint8_t s : Blob().texels())
    colours.insert(colours.end(), {s, std::uint8_t(255 - s), 90, std::uint8_t(s * s / 255 / 5)});
  return colours;
}

/// The eye's position after look(): 3 in front of the rotated cube.
std::array<double, 3> eye_of(double degrees) {
  const double angle = -degrees * M_PI / 180;
  const double length = std::sqrt(0.2 * 0.2 + 1 + 0.1 * 0.1);
  const std::array<double, 3> axis{0.2 / length, 1 / length, 0.1 / length};
  const std::array<double, 3> across{3 * axis[1], -3 * axis[0], 0};
  std::array<double, 3> eye{0, 0, 3 * std::cos(angle)};
  for (std::size_t k = 0; k < 3; ++k)
    eye[k] += across[k] * std::sin(angle) + axis[k] * 3 * axis[2] * (1 - std::cos(angle));
  return eye;
}

}  // namespace

std::vector<BrickedCube::Interval> BrickedCube::cut(int size, int edge) {
  std::vector<Interval> intervals;
  for (int first = 0;; first += edge - 1) {
    const bool last = first + edge >= size;
    const int texels = last ? size - first : edge;
    intervals.push_back(
        {first, texels, first == 0 ? 0.0 : (first + 0.5) / size, last ? 1.0 : (first + texels - 0.5) / size});
    if (last) return intervals;
  }
}

BrickedCube::BrickedCube(GlApplication& app, int edge, BrickKind kind) : kind_(std::move(kind)) {
  if (kind_.colour != nullptr) {
    std::string fragments =
        "#version 120\nuniform sampler3D field; varying vec3 place; void main() { "
        "vec4 texel = texture3D(field, place); float s = texel.r; gl_FragColor = ";
    fragments.append(kind_.colour).append("; }");
    program_ = glsl_program(app.gl(), vertices, fragments.c_str());
  }
  const Blob blob;
  size_ = {blob.x, blob.y, blob.z};
  const std::vector<std::uint8_t> colours = colours_of_blob();
  for (const Interval& z : cut(size_[2], edge))
    for (const Interval& y : cut(size_[1], edge))
      for (const Interval& x : cut(size_[0], edge)) {
        std::vector<std::uint8_t> part;
        for (int k = z.first; k < z.first + z.texels; ++k)
          for (int j = y.first; j < y.first + y.texels; ++j) {
            const auto row = colours.begin() + 4 * std::ptrdiff_t((k * size_[1] + j) * size_[0] + x.first);
            part.insert(part.end(), row, row + 4 * std::ptrdiff_t(x.texels));
          }
        GLuint texture = 0;
        app.gl().GenTextures(1, &texture);
        app.gl().BindTexture(GL_TEXTURE_3D, texture);
        app.gl().TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        app.gl().TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
          app.gl().TexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
        app.gl().TexImage3D(GL_TEXTURE_3D, 0, GLint(kind_.internal_format), x.texels, y.texels, z.texels, 0,
                            GL_RGBA, GL_UNSIGNED_BYTE, part.data());
        bricks_.push_back({{x, y, z}, texture});
      }
}

void BrickedCube::repaint(GlApplication& app, std::size_t brick) const {
  const Brick& painted = bricks_[brick];
  std::array<int, 3> extent{};
  for (std::size_t k = 0; k < 3; ++k) extent[k] = painted.along[k].texels - 2;
  std::vector<std::uint8_t> red;
  for (int i = 0; i < extent[0] * extent[1] * extent[2]; ++i) red.insert(red.end(), {255, 20, 20, 40});
  app.gl().BindTexture(GL_TEXTURE_3D, painted.texture);
  app.gl().TexSubImage3D(GL_TEXTURE_3D, 0, 1, 1, 1, extent[0], extent[1], extent[2], GL_RGBA, GL_UNSIGNED_BYTE,
                         red.data());
}

void BrickedCube::draw(GlApplication& app, const Brick& brick) const {
  app.gl().BindTexture(GL_TEXTURE_3D, brick.texture);
  const auto own = [&](std::size_t axis, double place) {
    return (place * size_[axis] - brick.along[axis].first) / brick.along[axis].texels;
  };
  const auto [x, y, z] = brick.along;
  app.gl().Begin(GL_QUADS);
  for (int i = 0; i < slices; ++i) {
    const double place = ((kind_.front_to_back ? slices - 1 - i : i) + 0.5) / slices;
    if (place < z.low || place >= z.high) continue;
    for (const auto& [u, v] : {std::pair{x.low, y.low}, {x.high, y.low}, {x.high, y.high}, {x.low, y.high}}) {
      app.gl().TexCoord3d(own(0, u), own(1, v), own(2, place));
      app.gl().Vertex3d(u - 0.5, v - 0.5, place - 0.5);
    }
  }
  app.gl().End();
}

void BrickedCube::draw(GlApplication& app, const Drawing& drawing) const {
  look(app, View::perspective, drawing.angle);
  const std::array<double, 3> eye = eye_of(drawing.angle);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < bricks_.size(); ++i) {
    if (!drawing.without.contains(i)) order.push_back(i);
  }
  const auto distance = [&](std::size_t i) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      sum += std::abs((bricks_[i].along[k].low + bricks_[i].along[k].high) / 2 - 0.5 - eye[k]);
    return drawing.wrong_order != kind_.front_to_back ? -sum : sum;
  };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return distance(a) > distance(b); });
  kind_.blending(app.gl());
  if (program_ != 0) app.gl().UseProgram(program_);
  std::size_t number = 0;
  for (const std::size_t i : order) {
    if (drawing.before_brick) drawing.before_brick(number++);
    app.gl().Enable(GL_BLEND);
    app.gl().Enable(GL_TEXTURE_3D);
    draw(app, bricks_[i]);
    if (drawing.blending_stays) continue;
    app.gl().Disable(GL_TEXTURE_3D);
    app.gl().Disable(GL_BLEND);
  }
  if (program_ != 0) app.gl().UseProgram(0);
  app.gl().Disable(GL_TEXTURE_3D);
  app.gl().Disable(GL_BLEND);
}

void BrickedCube::draw(GlApplication& app, double angle) const {
  Drawing drawing;
  drawing.angle = angle;
  draw(app, drawing);
}

}  // namespace understudy::spu::testing
