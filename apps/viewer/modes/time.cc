// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/time.h"

#include <algorithm>
#include <cmath>

#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/table_slices.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

constexpr int steps = 12;  ///< period, in time steps

std::vector<std::uint8_t> bytes_of(const Texels& texels) {
  const auto count = static_cast<std::size_t>(texels.size[0] * texels.size[1] * texels.size[2]);
  std::vector<std::uint8_t> bytes(count);
  for (std::size_t i = 0; i < count; ++i)
    bytes[i] = static_cast<std::uint8_t>(std::lround(255 * texel_value(texels, i)));
  return bytes;
}

class TimeMode : public Mode {
 public:
  TimeMode(const Texels& texels, const std::string& file, TimeStep step)
      : step_(step),
        size_(texels.size),
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
    std::array<std::int64_t, 3> low{}, high = size_;
    if (step_ != TimeStep::whole) {
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = size_[k] * 3 / 8;
        high[k] = std::max(low[k] + 1, size_[k] * 5 / 8);
      }
    }
    for (std::int64_t z = low[2]; z < high[2]; ++z)
      for (std::int64_t y = low[1]; y < high[1]; ++y)
        for (std::int64_t x = low[0]; x < high[0]; ++x) {
          const auto i = static_cast<std::size_t>((z * size_[1] + y) * size_[0] + x);
          shown_[i] = static_cast<std::uint8_t>(field_[i] * share / 256);
        }
    if (step_ == TimeStep::again) {
      low = {};
      high = size_;
    }
    glBindTexture(GL_TEXTURE_3D, volume_.name());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, static_cast<GLint>(size_[0]));
    glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, static_cast<GLint>(size_[1]));
    glTexSubImage3D(GL_TEXTURE_3D, 0, static_cast<GLint>(low[0]), static_cast<GLint>(low[1]),
                    static_cast<GLint>(low[2]), static_cast<GLsizei>(high[0] - low[0]),
                    static_cast<GLsizei>(high[1] - low[1]), static_cast<GLsizei>(high[2] - low[2]),
                    GL_LUMINANCE, GL_UNSIGNED_BYTE,
                    shown_.data() + (low[2] * size_[1] + low[1]) * size_[0] + low[0]);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, 0);
  }

  void draw_slices(const SliceStack& stack, const Matrices& matrices) override {
    slices_.draw(stack, matrices, volume_);
  }

  std::string_view texture_format() const override { return "GL_LUMINANCE8"; }

 private:
  TimeStep step_;
  VolumeSize size_;
  std::vector<std::uint8_t> field_;
  std::vector<std::uint8_t> shown_;
  Texture volume_;
  TableSlices slices_;
  int frame_ = 0;
};

}  // namespace

std::unique_ptr<Mode> make_time_mode(const Texels& texels, const std::string& file, TimeStep step) {
  return std::make_unique<TimeMode>(texels, file, step);
}

}  // namespace viewer
