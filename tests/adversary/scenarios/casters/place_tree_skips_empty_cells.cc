// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string skips_cells = R"(#version 330 core
uniform sampler3D volume;
uniform sampler3D occupied;  // of 8 x 8 x 8 cells: may anything show there?
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

void main() {
  vec3 dir = normalize(at - eye);
  vec3 planes = (step(0.0, dir) - at) / dir;
  float tmax = min(planes.x, min(planes.y, planes.z));
  int samples = int(tmax / step_length) + 1;
  vec4 acc = vec4(0.0);
  int i = 0;
  while (i < samples) {
    vec3 p = at + float(i) * step_length * dir;
    ivec3 cell = clamp(ivec3(floor(p * 8.0)), ivec3(0), ivec3(7));
    if (texelFetch(occupied, cell, 0).r < 0.5) {
      vec3 far = ((vec3(cell) + step(0.0, dir)) / 8.0 - p) / dir;
      float leave = min(far.x, min(far.y, far.z));
      i += max(1, int(floor(leave / step_length)));
      continue;
    }
    vec4 c = texture(table, vec2(texture(volume, p).r, 0.5));
    acc += (1.0 - acc.a) * vec4(c.rgb * c.a, c.a);
    ++i;
  }
  shown = acc;
}
)";

std::vector<Colour> leaves_or_wood(bool wood) {
  std::vector<Colour> colours;
  for (int i = 0; i < 256; ++i) {
    const float v = static_cast<float>(i) / 255;
    const float visible = wood ? (v < 0.66F ? 0 : 60 * v * v) : (v < 0.25F ? 0 : 10 + 26 * v);
    colours.push_back({static_cast<std::uint8_t>(60 + 140 * v * v), static_cast<std::uint8_t>(170 - 90 * v),
                       static_cast<std::uint8_t>(40 + 50 * std::abs(std::sin(9 * v))),
                       static_cast<std::uint8_t>(std::lround(visible))});
  }
  return colours;
}

/// Where the texels of a cell, and those next to it, have a value that shows.
std::vector<std::uint8_t> cells_of(const Grid& grid, const std::vector<Colour>& colours) {
  std::vector<std::uint8_t> cells;
  const int edge = grid.x / 8;
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 8; ++i) {
        float least = 1, most = 0;
        for (int z = std::max(0, k * edge - 1); z <= std::min(grid.z - 1, (k + 1) * edge); ++z)
          for (int y = std::max(0, j * edge - 1); y <= std::min(grid.y - 1, (j + 1) * edge); ++y)
            for (int x = std::max(0, i * edge - 1); x <= std::min(grid.x - 1, (i + 1) * edge); ++x) {
              const float value = grid.values[static_cast<std::size_t>(x + grid.x * (y + grid.y * z))];
              least = std::min(least, value), most = std::max(most, value);
            }
        bool shows = false;
        for (int entry = std::max(0, static_cast<int>(255 * least) - 2);
             entry <= std::min(255, static_cast<int>(255 * most) + 2); ++entry)
          shows = shows || colours[static_cast<std::size_t>(entry)][3] > 0;
        cells.push_back(shows ? 255 : 0);
      }
  return cells;
}

}  // namespace

Scenario place_tree_skips_empty_cells() {
  return {
      .sentence =
          "A tree of 64 bytes an edge; a texture of 8 x 8 x 8 cells, made anew with the table at frame 13, "
          "tells "
          "where whole steps may be left out, because nothing shows.",
      .expectation = Expectation::either,
      .key_frames = {13},
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field tree = [](float x, float y, float z) {
          const float a = x - 0.5F, b = z - 0.5F;
          const float trunk = std::exp(-(a * a + b * b) / 0.006F) * (y < 0.6F ? 1.0F : 0.3F);
          const float r = std::sqrt(a * a + b * b + (y - 0.65F) * (y - 0.65F));
          const float crown = std::clamp(2 - 6 * r, 0.0F, 1.0F) *
                              (0.45F + 0.3F * std::sin(25 * x) * std::sin(22 * y) * std::sin(27 * z + 1));
          return std::clamp(0.95F * trunk + crown, 0.0F, 1.0F);
        };
        const Grid grid = sampled(64, tree);
        auto scene = caster_scene(canvas, {.fragment = skips_cells,
                                           .grid = grid,
                                           .table = leaves_or_wood(false),
                                           .step_length = 0.02F,
                                           .orbit = {.azimuth = 10, .elevation = 15, .degrees_each_frame = 2}});
        const Gl& gl = canvas.gl;
        GLuint occupied = 0;
        gl.GenTextures(1, &occupied);
        gl.ActiveTexture(GL_TEXTURE2);
        gl.BindTexture(GL_TEXTURE_3D, occupied);
        filter_linearly(canvas, GL_TEXTURE_3D, GL_NEAREST);
        const std::vector<std::uint8_t> cells = cells_of(grid, leaves_or_wood(false));
        gl.TexImage3D(GL_TEXTURE_3D, 0, GL_R8, 8, 8, 8, 0, GL_RED, GL_UNSIGNED_BYTE, cells.data());
        scene->program.set("occupied", 2);
        return [&canvas, grid, scene](int frame) {
          if (frame == 13) {
            const std::vector<Colour> colours = leaves_or_wood(true);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
            const std::vector<std::uint8_t> cells = cells_of(grid, colours);
            canvas.gl.ActiveTexture(GL_TEXTURE2);
            canvas.gl.TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, 8, 8, 8, GL_RED, GL_UNSIGNED_BYTE, cells.data());
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
