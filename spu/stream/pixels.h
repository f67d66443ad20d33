// SPDX-License-Identifier: Apache-2.0
// The layout of images in the application's memory (OpenGL 4.6, section 8.4.4), and the one layout in a stream.
//
// In a stream, rows follow each other without gaps, components are in the machine's byte order, and bits start
// with the highest: the layout of GL_UNPACK_ALIGNMENT = 1 and zeros for all other parameters.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

/// GL_UNPACK_* or GL_PACK_*, in OpenGL's units (pixels, rows, bytes for alignment).
struct PixelStore {
  GLint swap_bytes = 0;
  GLint lsb_first = 0;
  GLint row_length = 0;
  GLint image_height = 0;
  GLint skip_rows = 0;
  GLint skip_pixels = 0;
  GLint skip_images = 0;
  GLint alignment = 4;

  bool operator==(const PixelStore&) const = default;
};

inline constexpr PixelStore tight_pixels{.alignment = 1};

/// The names of the fields in order, for glGetIntegerv and glPixelStorei.
inline constexpr std::array<GLenum, 8> unpack_names = {
    GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST,   GL_UNPACK_ROW_LENGTH,  GL_UNPACK_IMAGE_HEIGHT,
    GL_UNPACK_SKIP_ROWS,  GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_ALIGNMENT};
inline constexpr std::array<GLenum, 8> pack_names = {
    GL_PACK_SWAP_BYTES, GL_PACK_LSB_FIRST,   GL_PACK_ROW_LENGTH,  GL_PACK_IMAGE_HEIGHT,
    GL_PACK_SKIP_ROWS,  GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_IMAGES, GL_PACK_ALIGNMENT};

PixelStore pixel_store(const DispatchTable& gl, const std::array<GLenum, 8>& names);
/// Changes the parameters from `now` to `wanted`.
void set_pixel_store(const DispatchTable& gl, const std::array<GLenum, 8>& names, const PixelStore& now,
                     const PixelStore& wanted);

/// The image that a command specifies. `dimensions` are the command's, not the image's: they determine which
/// skips apply.
struct ImageShape {
  GLsizei width = 1;
  GLsizei height = 1;
  GLsizei depth = 1;
  GLenum format = GL_RGBA;
  GLenum type = GL_UNSIGNED_BYTE;
  int dimensions = 2;
};

/// Bytes of one pixel; nothing for combinations of format and type that OpenGL does not allow, and for bits.
std::optional<std::size_t> pixel_bytes(GLenum format, GLenum type);

/// Whether OpenGL allows the combination: it rejects others with an error, and reads nothing.
bool is_known_pixel(GLenum format, GLenum type);

/// Bytes from the application's pointer to the end of what is read or written with `store`; nothing if the
/// format is unknown or the size is unreasonable, 0 for an empty image.
std::optional<std::size_t> image_extent(const ImageShape& shape, const PixelStore& store);

/// Returns the image in the layout of streams. `pixels` must hold image_extent(shape, store) bytes.
std::vector<std::byte> tight_image(const ImageShape& shape, const PixelStore& store, const std::byte* pixels);

/// The reverse: copies an image from the layout of streams to the application's layout. `tight` holds
/// image_extent(shape, tight_pixels) bytes, `pixels` has room for image_extent(shape, store).
void spread_image(const ImageShape& shape, const PixelStore& store, const std::byte* tight, std::byte* pixels);

}  // namespace understudy::spu
