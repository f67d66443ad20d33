// SPDX-License-Identifier: Apache-2.0
// Lets us draw in the application's context without leaving a trace.
//
// Probing, capturing and presenting need a known pipeline for a short time. A SavedState reads all state that
// they may change, sets what all of them need (no blending, no tests, own vertex array, tight pixel transfer),
// and restores all of it in its destructor. Nothing here raises a GL error, and the error flag is never read:
// it is the application's.
#pragma once

#include <array>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

class SavedState {
 public:
  explicit SavedState(const GlContext& context);
  ~SavedState();
  SavedState(const SavedState&) = delete;
  SavedState& operator=(const SavedState&) = delete;

  /// Saves the texture and the sampler object bound to a unit's target, so that the caller may bind its own.
  /// Changes the active unit, which the destructor restores.
  void borrow_texture(GLenum target, int unit);
  /// Binds both again now; does nothing if they were not saved.
  void give_back_texture(GLenum target, int unit);

  /// Returns whether a capability that is disabled meanwhile was enabled.
  bool was_enabled(GLenum capability) const;

  GLuint draw_framebuffer() const { return GLuint(draw_framebuffer_); }

 private:
  struct BorrowedTexture {
    GLenum target;
    int unit;
    GLint texture;
    GLint sampler;
  };
  struct Capability {
    GLenum name;
    GLboolean enabled;
  };

  void bind_again(const BorrowedTexture& borrowed) const;

  const DispatchTable& gl_;
  bool core_;
  int version_;
  GLint draw_framebuffer_ = 0;
  GLint read_framebuffer_ = 0;
  GLint program_ = 0;
  GLint vertex_array_ = 0;
  GLint array_buffer_ = 0;
  GLint pack_buffer_ = 0;
  GLint unpack_buffer_ = 0;
  GLint active_texture_ = 0;
  std::array<GLint, 4> viewport_{};
  std::array<GLint, 2> polygon_mode_{};
  std::array<GLboolean, 4> color_mask_{};
  GLboolean depth_mask_ = 0;
  std::array<GLint, 4> blend_factors_{};
  std::array<GLint, 2> blend_equations_{};
  std::array<GLint, 16> pixel_store_{};
  GLfloat depth_scale_ = 1;  ///< of pixel transfer, in compatibility contexts
  GLfloat depth_bias_ = 0;
  std::vector<Capability> capabilities_;
  std::vector<BorrowedTexture> borrowed_;
};

}  // namespace understudy::spu
