// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/context/kept_errors.h"

#include <algorithm>

namespace understudy::spu {
namespace {

/// Calls `take` for each error in the queue. OpenGL has fewer kinds than are taken here; a lost context returns
/// its error again and again.
template <class Take>
void empty_queue(const DispatchTable& gl, Take take) {
  constexpr int most_errors = 16;
  for (int i = 0; i < most_errors; ++i) {
    const GLenum error = gl.GetError();
    if (error == GL_NO_ERROR) return;
    take(error);
  }
}

}  // namespace

GLenum take_error(const DispatchTable& gl) {
  GLenum first = GL_NO_ERROR;
  empty_queue(gl, [&](GLenum error) {
    if (first == GL_NO_ERROR) first = error;
  });
  return first;
}

GLenum KeptErrors::take() {
  if (errors_.empty()) return GL_NO_ERROR;
  const GLenum error = errors_.front();
  errors_.erase(errors_.begin());
  return error;
}

OwnErrors::OwnErrors(const DispatchTable& gl, KeptErrors& kept) : gl_(gl), kept_(kept) {
  if (kept_.nested_ == 0) {
    empty_queue(gl_, [&](GLenum error) {
      if (std::ranges::find(kept_.errors_, error) == kept_.errors_.end()) kept_.errors_.push_back(error);
    });
  }
  ++kept_.nested_;
}

OwnErrors::~OwnErrors() {
  if (--kept_.nested_ == 0) take_error(gl_);
}

}  // namespace understudy::spu
