// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/table.h"

#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/table_slices.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

class TableMode : public Mode {
 public:
  TableMode(const Texels& texels, const std::string& file)
      : format_(luminance_format(texels.format)),
        volume_(make_volume_texture(format_, texels.size, texels.data.data(), file)),
        slices_("table") {}

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

std::unique_ptr<Mode> make_table_mode(const Texels& texels, const std::string& file) {
  return std::make_unique<TableMode>(texels, file);
}

}  // namespace viewer
