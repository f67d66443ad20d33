#include "apps/viewer/modes/time.h"

#include <cmath>

#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/table_slices.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

constexpr int steps = 12;  ///< until the volume looks as at first

std::vector<std::uint8_t> bytes_of(const Texels& texels) {
  const auto count = static_cast<std::size_t>(texels.size[0] * texels.size[1] * texels.size[2]);
  std::vector<std::uint8_t> bytes(count);
  for (std::size_t i = 0; i < count; ++i)
    bytes[i] = static_cast<std::uint8_t>(std::lround(255 * texel_value(texels, i)));
  return bytes;
}

class TimeMode : public Mode {
 public:
  TimeMode(const Texels& texels, const std::string& file)
      : size_(texels.size),
        field_(bytes_of(texels)),
        shown_(field_),
        volume_(make_volume_texture(luminance_format(TexelFormat::unorm8), size_, field_.data(), file)),
        slices_("time") {}

  void set_table(const Table& table) override { upload_table(slices_.table(), table); }

  void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) override {
    draw_opaque_immediate(geometry, matrices);
  }

  void next_frame() override {
    const double phase = 2 * std::numbers::pi * (frame_++ % steps) / steps;
    const int share = static_cast<int>(std::lround(256 * (0.8 + 0.2 * std::cos(phase))));
    for (std::size_t i = 0; i < field_.size(); ++i)
      shown_[i] = static_cast<std::uint8_t>(field_[i] * share / 256);
    glBindTexture(GL_TEXTURE_3D, volume_.name());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, static_cast<GLsizei>(size_[0]), static_cast<GLsizei>(size_[1]),
                    static_cast<GLsizei>(size_[2]), GL_LUMINANCE, GL_UNSIGNED_BYTE, shown_.data());
  }

  void draw_slices(const SliceStack& stack, const Matrices& matrices) override {
    slices_.draw(stack, matrices, volume_);
  }

  std::string_view texture_format() const override { return "GL_LUMINANCE8"; }

 private:
  VolumeSize size_;
  std::vector<std::uint8_t> field_;
  std::vector<std::uint8_t> shown_;
  Texture volume_;
  TableSlices slices_;
  int frame_ = 0;
};

}  // namespace

std::unique_ptr<Mode> make_time_mode(const Texels& texels, const std::string& file) {
  return std::make_unique<TimeMode>(texels, file);
}

}  // namespace viewer
