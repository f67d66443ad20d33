// SPDX-License-Identifier: Apache-2.0
// Which framebuffers lack the depth of substituted runs, or would if it had not been drawn in a first frame
// (deferred_depth_write.h).
#pragma once

#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

class DeferredDepth {
 public:
  struct Watched {
    GLuint framebuffer = 0;
    GLuint volume = 0;  ///< the texture of the volume whose run would have written it
    /// A texture is attached, which others may sample once another framebuffer is bound.
    bool in_texture = false;
    GLuint renderbuffer = 0;  ///< attached in place of one; 0: none
  };

  bool empty() const { return watched_.empty(); }
  /// The volumes whose depth nobody can be kept from looking at any longer: of most_framebuffers at once, the
  /// oldest.
  std::vector<GLuint> add(const Watched& watched);
  /// The depth of `framebuffer` is cleared, or looked at: the volumes that it would have been of.
  std::vector<GLuint> take(GLuint framebuffer);
  std::vector<GLuint> take_all();
  /// Another framebuffer is bound: the volumes whose depth lies in textures that are no longer attached to it.
  std::vector<GLuint> take_textures_outside(GLuint framebuffer);
  /// The renderbuffer is attached elsewhere, too.
  std::vector<GLuint> take_renderbuffer(GLuint renderbuffer);

  static constexpr std::size_t most_framebuffers = 4;

 private:
  template <typename Condition>
  std::vector<GLuint> take_if(Condition condition);

  std::vector<Watched> watched_;  ///< oldest first
};

}  // namespace understudy::spu
