// SPDX-License-Identifier: Apache-2.0
// The volume's 3-D texture and the 1-D colour table, both linear and clamped to the edge.
#pragma once

#include <string>
#include <string_view>

#include "apps/viewer/model/texels.h"
#include "apps/viewer/model/transfer_function.h"
#include "apps/viewer/modes/gl_objects.h"

namespace viewer {

struct VolumeTextureFormat {
  GLint internal_format;
  GLenum format;
  GLenum type;
  std::string_view name;  ///< name of the internal format
};

/// LUMINANCE formats for compatibility profiles, RED formats for core profiles, which have no luminance.
VolumeTextureFormat luminance_format(TexelFormat format);
VolumeTextureFormat red_format(TexelFormat format);
inline constexpr VolumeTextureFormat rgba_format = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, "GL_RGBA8"};

/// Uploads `data`. Throws Error (bad_file) with `file` and the limit if the volume
/// exceeds the driver's limits.
Texture make_volume_texture(const VolumeTextureFormat& format, const VolumeSize& size, const void* data,
                            const std::string& file);

Texture make_table_texture();
void upload_table(const Texture& texture, const Table& table);

}  // namespace viewer
