// SPDX-License-Identifier: Apache-2.0
// Owns a texture name. Create and destroy it while the device's context is current.
#pragma once

#include <utility>

#include "volume/glsl/functions.h"

namespace understudy::volume::glsl {

class Texture {
 public:
  explicit Texture(const Functions& gl) : gl_(&gl) { gl.GenTextures(1, &name_); }
  Texture(Texture&& other) noexcept : gl_(other.gl_), name_(std::exchange(other.name_, 0)) {}
  Texture& operator=(Texture&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(name_, other.name_);
    return *this;
  }
  ~Texture() {
    if (name_ != 0) gl_->DeleteTextures(1, &name_);
  }
  GLuint name() const { return name_; }

 private:
  const Functions* gl_;
  GLuint name_ = 0;
};

}  // namespace understudy::volume::glsl
