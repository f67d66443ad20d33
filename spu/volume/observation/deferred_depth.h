// SPDX-License-Identifier: Apache-2.0
// Which framebuffers lack the depth of substituted runs, or would if it had not been drawn in a first frame
// (depth/deferred_depth_write.h).
#pragma once

#include <optional>
#include <vector>

#include "dispatch/table.h"
#include "volume/rect.h"

namespace understudy::spu {

class DeferredDepth {
 public:
  struct Watched {
    GLuint framebuffer = 0;
    GLuint volume = 0;    ///< the texture of the volume whose run would have written it
    volume::Rect pixels;  ///< where it would have
    /// A texture is attached, which may be sampled.
    bool in_texture = false;
    GLuint renderbuffer = 0;  ///< attached in place of one; 0: none
  };

  bool empty() const { return watched_.empty(); }
  /// Gives the volumes whose depth is watched no longer: most_framebuffers are at once, and the oldest counts
  /// as looked at.
  std::vector<GLuint> add(const Watched& watched);

  // Each takes what is concerned out, and gives the volumes that it is of.

  std::vector<GLuint> take_all();
  /// Looked at in the framebuffer, or through the renderbuffer (0: none) that another framebuffer shares with
  /// it.
  std::vector<GLuint> take(GLuint framebuffer, GLuint renderbuffer);
  /// The depth of the framebuffer is cleared, in the pixels of `part` if it is set.
  std::vector<GLuint> take_cleared(GLuint framebuffer, const std::optional<volume::Rect>& part);
  /// All that lies in textures, but for that of the framebuffer, if it is set.
  std::vector<GLuint> take_textures(std::optional<GLuint> but_of);

  static constexpr std::size_t most_framebuffers = 4;

 private:
  template <typename Condition>
  std::vector<GLuint> take_if(Condition condition);

  std::vector<Watched> watched_;  ///< oldest first
};

}  // namespace understudy::spu
