// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/slice_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

class VolumeOfSlices : public VolumeFile {
 public:
  VolumeOfSlices(const FileDescription& description, std::unique_ptr<SliceImages> images, std::string path)
      : VolumeFile(description), images_(std::move(images)), path_(std::move(path)) {}

  void read(const TexelBox& box, std::span<std::byte> scalars) override {
    if (!contains({{0, 0, 0}, description().size}, box) ||
        scalars.size() != texels_in(box) * bytes_per_scalar(description().type))
      throw FileError(fmt::format("{}: a part was asked for that the volume does not have", path_));
    if (is_empty(box)) return;
    const std::size_t part = scalars.size() / std::size_t(box.high[2] - box.low[2]);
    std::vector<std::byte> whole(part == slice_bytes() ? 0 : slice_bytes());
    for (int z = box.low[2]; z < box.high[2]; ++z) {
      const std::span<std::byte> to = scalars.subspan(std::size_t(z - box.low[2]) * part, part);
      images_->read(z, whole.empty() ? to : std::span(whole));
      if (!whole.empty()) copy_rows(box, whole, to);
    }
  }

  std::uint64_t bytes_read() const override { return images_->bytes_read(); }
  std::size_t memory_to_read(const TexelBox& /*box*/) const override {
    return images_->memory_to_read() + slice_bytes();
  }

 private:
  std::size_t slice_bytes() const {
    const std::array<int, 3>& size = description().size;
    return std::size_t(size[0]) * std::size_t(size[1]) * bytes_per_scalar(description().type);
  }

  /// Copies the rows of one slice that lie in `box`.
  void copy_rows(const TexelBox& box, std::span<const std::byte> slice, std::span<std::byte> to) const {
    const std::size_t scalar = bytes_per_scalar(description().type);
    const std::size_t row = std::size_t(box.high[0] - box.low[0]) * scalar;
    std::byte* next = to.data();
    for (int y = box.low[1]; y < box.high[1]; ++y, next += row) {
      const std::size_t first = std::size_t(y) * std::size_t(description().size[0]) + std::size_t(box.low[0]);
      std::copy_n(slice.data() + first * scalar, row, next);
    }
  }

  std::unique_ptr<SliceImages> images_;
  std::string path_;
};

}  // namespace

std::unique_ptr<VolumeFile> volume_of_slices(const FileDescription& description,
                                             std::unique_ptr<SliceImages> images, std::string path) {
  return std::make_unique<VolumeOfSlices>(description, std::move(images), std::move(path));
}

}  // namespace understudy::volume
