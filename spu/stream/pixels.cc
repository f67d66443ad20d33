// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/pixels.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace understudy::spu {
namespace {

/// Larger than any image that OpenGL accepts: larger sizes are rejected before they could overflow.
constexpr std::uint64_t most_image_bytes = std::uint64_t(1) << 40;

std::optional<std::size_t> components_of_format(GLenum format) {
  switch (format) {
    case GL_RED:
    case GL_GREEN:
    case GL_BLUE:
    case GL_ALPHA:
    case GL_LUMINANCE:
    case GL_INTENSITY:
    case GL_COLOR_INDEX:
    case GL_STENCIL_INDEX:
    case GL_DEPTH_COMPONENT:
    case GL_RED_INTEGER:
    case GL_GREEN_INTEGER:
    case GL_BLUE_INTEGER:
    case GL_ALPHA_INTEGER:
    case GL_LUMINANCE_INTEGER_EXT:
      return 1;
    case GL_RG:
    case GL_RG_INTEGER:
    case GL_LUMINANCE_ALPHA:
    case GL_LUMINANCE_ALPHA_INTEGER_EXT:
    case GL_DUDV_ATI:
    case GL_DEPTH_STENCIL:
    case GL_YCBCR_MESA:
      return 2;
    case GL_RGB:
    case GL_BGR:
    case GL_RGB_INTEGER:
    case GL_BGR_INTEGER:
      return 3;
    case GL_RGBA:
    case GL_BGRA:
    case GL_RGBA_INTEGER:
    case GL_BGRA_INTEGER:
    case GL_ABGR_EXT:
    case GL_CMYK_EXT:
      return 4;
    case GL_CMYKA_EXT:
      return 5;
    default:
      return std::nullopt;
  }
}

struct TypeSize {
  std::size_t bytes;  ///< of a component, or of the whole pixel if packed
  std::size_t swap;   ///< number of bytes that GL_UNPACK_SWAP_BYTES reverses
  bool packed;
};

std::optional<TypeSize> type_size(GLenum type) {
  switch (type) {
    case GL_UNSIGNED_BYTE:
    case GL_BYTE:
      return TypeSize{1, 1, false};
    case GL_UNSIGNED_SHORT:
    case GL_SHORT:
    case GL_HALF_FLOAT:
      return TypeSize{2, 2, false};
    case GL_UNSIGNED_INT:
    case GL_INT:
    case GL_FLOAT:
      return TypeSize{4, 4, false};
    case GL_DOUBLE:
      return TypeSize{8, 8, false};
    case GL_UNSIGNED_BYTE_3_3_2:
    case GL_UNSIGNED_BYTE_2_3_3_REV:
      return TypeSize{1, 1, true};
    case GL_UNSIGNED_SHORT_5_6_5:
    case GL_UNSIGNED_SHORT_5_6_5_REV:
    case GL_UNSIGNED_SHORT_4_4_4_4:
    case GL_UNSIGNED_SHORT_4_4_4_4_REV:
    case GL_UNSIGNED_SHORT_5_5_5_1:
    case GL_UNSIGNED_SHORT_1_5_5_5_REV:
    case GL_UNSIGNED_SHORT_8_8_MESA:
    case GL_UNSIGNED_SHORT_8_8_REV_MESA:
      return TypeSize{2, 2, true};
    case GL_UNSIGNED_INT_8_8_8_8:
    case GL_UNSIGNED_INT_8_8_8_8_REV:
    case GL_UNSIGNED_INT_10_10_10_2:
    case GL_UNSIGNED_INT_2_10_10_10_REV:
    case GL_UNSIGNED_INT_24_8:
    case GL_UNSIGNED_INT_10F_11F_11F_REV:
    case GL_UNSIGNED_INT_5_9_9_9_REV:
      return TypeSize{4, 4, true};
    case GL_FLOAT_32_UNSIGNED_INT_24_8_REV:
      return TypeSize{8, 4, true};
    default:
      return std::nullopt;
  }
}

/// Strides within an image, in bytes; `bits` if a pixel is one bit.
struct Layout {
  std::uint64_t row = 0;         ///< used bytes of a row
  std::uint64_t row_step = 0;    ///< from row to row
  std::uint64_t image_step = 0;  ///< from image to image
  std::uint64_t skip = 0;        ///< to the first pixel; for bits, to its byte
  std::size_t swap = 1;
  bool bits = false;
};

std::optional<Layout> layout_of(const ImageShape& shape, const PixelStore& store) {
  Layout layout;
  layout.bits = shape.type == GL_BITMAP;
  const std::uint64_t width = std::uint64_t(shape.width);
  const std::uint64_t length = store.row_length > 0 ? std::uint64_t(store.row_length) : width;
  const std::uint64_t rows = shape.dimensions > 2 && store.image_height > 0 ? std::uint64_t(store.image_height)
                                                                            : std::uint64_t(shape.height);
  const std::uint64_t alignment = std::uint64_t(std::max(store.alignment, 1));
  std::uint64_t unpadded = 0;
  std::uint64_t skip_in_row = 0;
  if (layout.bits) {
    layout.row = (width + std::uint64_t(store.skip_pixels) % 8 + 7) / 8;
    unpadded = (length + 7) / 8;
    skip_in_row = std::uint64_t(store.skip_pixels) / 8;
  } else {
    const auto pixel = pixel_bytes(shape.format, shape.type);
    if (!pixel) return std::nullopt;
    layout.swap = store.swap_bytes != 0 ? type_size(shape.type)->swap : 1;
    layout.row = width * *pixel;
    unpadded = length * *pixel;
    skip_in_row = std::uint64_t(store.skip_pixels) * *pixel;
  }
  layout.row_step = (unpadded + alignment - 1) / alignment * alignment;
  if (layout.row_step > most_image_bytes ||
      rows > most_image_bytes / std::max<std::uint64_t>(layout.row_step, 1))
    return std::nullopt;
  if (shape.dimensions > 1 &&
      std::uint64_t(store.skip_rows) > most_image_bytes / std::max<std::uint64_t>(layout.row_step, 1)) {
    return std::nullopt;
  }
  layout.image_step = layout.row_step * rows;
  if (std::uint64_t(shape.depth) + std::uint64_t(store.skip_images) >
      most_image_bytes / std::max<std::uint64_t>(layout.image_step, 1)) {
    return std::nullopt;
  }
  layout.skip = skip_in_row + (shape.dimensions > 1 ? std::uint64_t(store.skip_rows) * layout.row_step : 0) +
                (shape.dimensions > 2 ? std::uint64_t(store.skip_images) * layout.image_step : 0);
  return layout;
}

bool empty(const ImageShape& shape) {
  return shape.width <= 0 || shape.height <= 0 || shape.depth <= 0;
}

/// Copies one row of bits, so that the first pixel is in the highest bit of the first byte.
void copy_bits(const std::byte* from, std::size_t first_bit, std::size_t width, bool lsb_first, std::byte* to) {
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t bit = first_bit + i;
    const auto byte = std::to_integer<unsigned>(from[bit / 8]);
    const unsigned value = lsb_first ? byte >> bit % 8 & 1U : byte >> (7 - bit % 8) & 1U;
    if (value != 0) to[i / 8] |= std::byte(0x80U >> i % 8);
  }
}

/// The reverse; bits outside the row are unchanged.
void spread_bits(const std::byte* from, std::size_t first_bit, std::size_t width, bool lsb_first,
                 std::byte* to) {
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t bit = first_bit + i;
    const auto mask = std::byte(lsb_first ? 1U << bit % 8 : 0x80U >> bit % 8);
    const bool set = (from[i / 8] & std::byte(0x80U >> i % 8)) != std::byte(0);
    to[bit / 8] = set ? to[bit / 8] | mask : to[bit / 8] & ~mask;
  }
}

}  // namespace

PixelStore pixel_store(const DispatchTable& gl, const std::array<GLenum, 8>& names) {
  PixelStore store;
  const std::array<GLint*, 8> fields = {&store.swap_bytes,   &store.lsb_first, &store.row_length,
                                        &store.image_height, &store.skip_rows, &store.skip_pixels,
                                        &store.skip_images,  &store.alignment};
  for (std::size_t i = 0; i < names.size(); ++i) gl.GetIntegerv(names[i], fields[i]);
  return store;
}

void set_pixel_store(const DispatchTable& gl, const std::array<GLenum, 8>& names, const PixelStore& now,
                     const PixelStore& wanted) {
  const std::array<GLint PixelStore::*, 8> fields = {
      &PixelStore::swap_bytes, &PixelStore::lsb_first,   &PixelStore::row_length,  &PixelStore::image_height,
      &PixelStore::skip_rows,  &PixelStore::skip_pixels, &PixelStore::skip_images, &PixelStore::alignment};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (now.*fields[i] != wanted.*fields[i]) gl.PixelStorei(names[i], wanted.*fields[i]);
  }
}

std::optional<std::size_t> pixel_bytes(GLenum format, GLenum type) {
  const auto size = type_size(type);
  const auto count = components_of_format(format);
  if (!size || !count) return std::nullopt;
  return size->packed ? size->bytes : size->bytes * *count;
}

bool is_known_pixel(GLenum format, GLenum type) {
  return type == GL_BITMAP || pixel_bytes(format, type);
}

std::optional<std::size_t> image_extent(const ImageShape& shape, const PixelStore& store) {
  if (empty(shape)) return 0;
  const auto layout = layout_of(shape, store);
  if (!layout) return std::nullopt;
  return layout->skip + layout->image_step * std::uint64_t(shape.depth - 1) +
         layout->row_step * std::uint64_t(shape.height - 1) + layout->row;
}

std::vector<std::byte> tight_image(const ImageShape& shape, const PixelStore& store, const std::byte* pixels) {
  if (empty(shape)) return {};
  const auto from = layout_of(shape, store);
  const auto to = layout_of(shape, tight_pixels);
  if (!from || !to) return {};
  std::vector<std::byte> image(to->image_step * std::uint64_t(shape.depth));
  for (std::uint64_t layer = 0; layer < std::uint64_t(shape.depth); ++layer) {
    for (std::uint64_t row = 0; row < std::uint64_t(shape.height); ++row) {
      const std::byte* source = pixels + from->skip + layer * from->image_step + row * from->row_step;
      std::byte* target = image.data() + layer * to->image_step + row * to->row_step;
      if (from->bits) {
        copy_bits(source, std::size_t(store.skip_pixels) % 8, std::size_t(shape.width), store.lsb_first != 0,
                  target);
      } else {
        std::memcpy(target, source, to->row);
      }
    }
  }
  if (from->swap > 1) {
    for (std::size_t i = 0; i + from->swap <= image.size(); i += from->swap)
      std::reverse(image.begin() + std::ptrdiff_t(i), image.begin() + std::ptrdiff_t(i + from->swap));
  }
  return image;
}

void spread_image(const ImageShape& shape, const PixelStore& store, const std::byte* tight, std::byte* pixels) {
  if (empty(shape)) return;
  const auto from = layout_of(shape, tight_pixels);
  const auto to = layout_of(shape, store);
  if (!from || !to) return;
  for (std::uint64_t layer = 0; layer < std::uint64_t(shape.depth); ++layer) {
    for (std::uint64_t row = 0; row < std::uint64_t(shape.height); ++row) {
      const std::byte* source = tight + layer * from->image_step + row * from->row_step;
      std::byte* target = pixels + to->skip + layer * to->image_step + row * to->row_step;
      if (to->bits) {
        spread_bits(source, std::size_t(store.skip_pixels) % 8, std::size_t(shape.width), store.lsb_first != 0,
                    target);
        continue;
      }
      std::memcpy(target, source, from->row);
      for (std::size_t i = 0; to->swap > 1 && i + to->swap <= from->row; i += to->swap)
        std::reverse(target + i, target + i + to->swap);
    }
  }
}

}  // namespace understudy::spu
