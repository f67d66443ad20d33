// SPDX-License-Identifier: Apache-2.0
// Records which framebuffers lack the depth of substituted runs, or would lack it had it not been drawn in a
// first frame (depth/deferred_depth_write.h).
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
    GLuint volume = 0;    ///< texture of the volume whose run would have written the depth
    volume::Rect pixels;  ///< where the run would have written it
    /// The depth attachment is a texture, which may be sampled.
    bool in_texture = false;
    GLuint renderbuffer = 0;  ///< attached instead of a texture; 0: none
  };

  bool empty() const { return watched_.empty(); }
  /// Returns the volumes whose depth is no longer watched: no more than most_framebuffers are watched, and the
  /// oldest then counts as read.
  std::vector<GLuint> add(const Watched& watched);

  // Each of these removes the depth concerned, and returns the volumes that it belongs to.

  std::vector<GLuint> take_all();
  /// Depth that is read in the framebuffer, or through the renderbuffer (0: none) that another framebuffer
  /// shares with it.
  std::vector<GLuint> take(GLuint framebuffer, GLuint renderbuffer);
  /// Depth of the framebuffer that is cleared, within the pixels of `part` if it is set.
  std::vector<GLuint> take_cleared(GLuint framebuffer, const std::optional<volume::Rect>& part);
  /// All depth in textures, except that of framebuffer `but_of`, if it is set.
  std::vector<GLuint> take_textures(std::optional<GLuint> but_of);

  static constexpr std::size_t most_framebuffers = 4;

 private:
  template <typename Condition>
  std::vector<GLuint> take_if(Condition condition);

  std::vector<Watched> watched_;  ///< oldest first
};

}  // namespace understudy::spu
