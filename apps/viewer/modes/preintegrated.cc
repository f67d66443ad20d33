// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/preintegrated.h"

#include <algorithm>
#include <cmath>

#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/table_slices.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

constexpr const char* vertex_source = R"(#version 120
uniform vec3 segment;
varying vec3 front;
varying vec3 back;
void main() {
  front = gl_MultiTexCoord0.xyz;
  back = front + segment;
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)";

constexpr const char* fragment_source = R"(#version 120
uniform sampler3D volume;
uniform sampler2D table;
varying vec3 front;
varying vec3 back;
void main() {
  vec2 values = vec2(texture3D(volume, front).r, texture3D(volume, back).r);
  gl_FragColor = texture2D(table, (values * 255.0 + 0.5) / 256.0);
}
)";

/// Returns the mean colour and opacity between each pair of values; colours are weighted by their opacity.
std::vector<Rgba8> integrate(const Table& table) {
  const std::size_t n = table.size();
  // Sums of the entries below i; the means of all pairs are computed from differences of these sums.
  std::vector<std::array<double, 4>> below(n + 1);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t channel = 0; channel < 3; ++channel)
      below[i + 1][channel] = below[i][channel] + table[i][channel] * (table[i][3] + 1e-3);
    below[i + 1][3] = below[i][3] + table[i][3] + 1e-3;
  }
  std::vector<Rgba8> pairs(n * n);
  for (std::size_t back = 0; back < n; ++back) {
    for (std::size_t front = 0; front < n; ++front) {
      const auto [low, high] = std::minmax(front, back);
      const double weight = below[high + 1][3] - below[low][3];
      Rgba8& pair = pairs[back * n + front];
      for (std::size_t channel = 0; channel < 3; ++channel)
        pair[channel] =
            static_cast<std::uint8_t>(std::lround((below[high + 1][channel] - below[low][channel]) / weight));
      pair[3] = static_cast<std::uint8_t>(std::lround(weight / static_cast<double>(high - low + 1)));
    }
  }
  return pairs;
}

class PreintegratedMode : public Mode {
 public:
  PreintegratedMode(const Texels& texels, const std::string& file)
      : format_(luminance_format(texels.format)),
        box_(box_of(texels.size, texels.spacing)),
        volume_(make_volume_texture(format_, texels.size, texels.data.data(), file)),
        slices_("pre-integration", vertex_source, fragment_source) {}

  void set_table(const Table& table) override {
    glBindTexture(GL_TEXTURE_2D, pairs_.name());
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    const auto edge = static_cast<GLsizei>(table.size());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, edge, edge, 0, GL_RGBA, GL_UNSIGNED_BYTE, integrate(table).data());
  }

  void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) override {
    draw_opaque_immediate(geometry, matrices);
  }

  void draw_slices(const SliceStack& stack, const Matrices& matrices) override {
    glUseProgram(slices_.program());
    const Vec3 segment = stack.spacing * stack.normal;
    glUniform3f(glGetUniformLocation(slices_.program(), "segment"),
                static_cast<float>(segment[0] / box_.edges[0]), static_cast<float>(segment[1] / box_.edges[1]),
                static_cast<float>(segment[2] / box_.edges[2]));
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, pairs_.name());
    glActiveTexture(GL_TEXTURE0);
    slices_.draw(stack, matrices, volume_);
  }

  std::string_view texture_format() const override { return format_.name; }

 private:
  VolumeTextureFormat format_;
  Box box_;
  Texture volume_;
  Texture pairs_ = make_texture();
  TableSlices slices_;
};

}  // namespace

std::unique_ptr<Mode> make_preintegrated_mode(const Texels& texels, const std::string& file) {
  return std::make_unique<PreintegratedMode>(texels, file);
}

}  // namespace viewer
