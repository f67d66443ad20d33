// SPDX-License-Identifier: Apache-2.0
// Volumes and tables as textures.
#pragma once

#include <vector>

#include "tests/adversary/canvas.h"
#include "tests/adversary/grid.h"
#include "tests/adversary/transfer_function.h"

namespace adversary {

/// What a texel is stored as. Normalised ones hold 0 to 1 (`signed16`: -1 to 1).
enum class Texel { unsigned8, unsigned16, signed16, half, float32 };
/// What the shader, or fixed function, gets of it.
enum class Shown { red, luminance, intensity, colour };

struct VolumeFormat {
  Texel texel = Texel::unsigned8;
  Shown shown = Shown::red;
  GLenum filter = GL_LINEAR;
};

/// Creates the texture, and leaves it bound to GL_TEXTURE_3D of `unit`, which is then active.
GLuint upload_volume(const Canvas& canvas, int unit, const Grid& grid, VolumeFormat format = {});
/// Replaces a box of it, as viewers do with glTexSubImage3D. The texture must be bound to the active unit.
void replace_texels(const Canvas& canvas, const Grid& grid, VolumeFormat format, int x = 0, int y = 0,
                    int z = 0);
/// Whole numbers of 8 bits, for usampler3D.
GLuint upload_labels(const Canvas& canvas, int unit, const Grid& grid);

/// Each creates the texture and leaves it bound to `unit`, which is then active.
GLuint upload_table_1d(const Canvas& canvas, int unit, const std::vector<Colour>& colours);
GLuint upload_table_2d(const Canvas& canvas, int unit, const std::vector<Colour>& colours, int rows = 1,
                       GLenum filter = GL_LINEAR);
/// A mask of 8 bits, `columns` a row.
GLuint upload_mask_2d(const Canvas& canvas, int unit, const std::vector<std::uint8_t>& values, int columns);
void filter_linearly(const Canvas& canvas, GLenum target, GLenum filter = GL_LINEAR);

}  // namespace adversary
