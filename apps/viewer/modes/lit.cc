// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/lit.h"

#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/table_slices.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

// Central differences over one voxel. Where the field is flat, there is no surface and no shading.
constexpr const char* lit_fragment_source = R"(#version 120
uniform sampler3D volume;
uniform sampler1D table;
uniform vec3 voxel;
float at(vec3 offset) { return texture3D(volume, gl_TexCoord[0].xyz + offset).r; }
void main() {
  vec3 dx = vec3(voxel.x, 0.0, 0.0), dy = vec3(0.0, voxel.y, 0.0), dz = vec3(0.0, 0.0, voxel.z);
  vec3 slope = vec3(at(dx) - at(-dx), at(dy) - at(-dy), at(dz) - at(-dz));
  float steepness = length(slope);
  float facing = abs(dot(slope, normalize(vec3(0.4, -0.7, 0.6)))) / max(steepness, 1e-4);
  float light = mix(1.0, 0.3 + 0.7 * facing, min(8.0 * steepness, 1.0));
  vec4 colour = texture1D(table, (at(vec3(0.0)) * 255.0 + 0.5) / 256.0);
  gl_FragColor = vec4(colour.rgb * light, colour.a);
}
)";

class LitMode : public Mode {
 public:
  LitMode(const Texels& texels, const std::string& file)
      : format_(luminance_format(texels.format)),
        volume_(make_volume_texture(format_, texels.size, texels.data.data(), file)),
        slices_("lit", nullptr, lit_fragment_source) {
    glUseProgram(slices_.program());
    glUniform3f(glGetUniformLocation(slices_.program(), "voxel"), 1.0F / static_cast<float>(texels.size[0]),
                1.0F / static_cast<float>(texels.size[1]), 1.0F / static_cast<float>(texels.size[2]));
    glUseProgram(0);
  }

  void set_table(const Table& table) override { upload_table(slices_.table(), table); }

  void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) override {
    draw_opaque_immediate(geometry, matrices);
  }

  void draw_slices(const SliceStack& stack, const Matrices& matrices) override {
    slices_.draw(stack, matrices, volume_);
  }

  std::string_view texture_format() const override { return format_.name; }

 private:
  VolumeTextureFormat format_;
  Texture volume_;
  TableSlices slices_;
};

}  // namespace

std::unique_ptr<Mode> make_lit_mode(const Texels& texels, const std::string& file) {
  return std::make_unique<LitMode>(texels, file);
}

}  // namespace viewer
