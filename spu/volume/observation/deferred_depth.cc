// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/deferred_depth.h"

namespace understudy::spu {

template <typename Condition>
std::vector<GLuint> DeferredDepth::take_if(Condition condition) {
  std::vector<GLuint> volumes;
  std::erase_if(watched_, [&](const Watched& each) {
    if (!condition(each)) return false;
    volumes.push_back(each.volume);
    return true;
  });
  return volumes;
}

std::vector<GLuint> DeferredDepth::add(const Watched& watched) {
  std::vector<GLuint> looked_at;
  if (watched_.size() >= most_framebuffers) {
    looked_at.push_back(watched_.front().volume);
    watched_.erase(watched_.begin());
  }
  watched_.push_back(watched);
  return looked_at;
}

std::vector<GLuint> DeferredDepth::take_all() {
  return take_if([](const Watched&) { return true; });
}

std::vector<GLuint> DeferredDepth::take(GLuint framebuffer, GLuint renderbuffer) {
  return take_if([&](const Watched& each) {
    return each.framebuffer == framebuffer || (renderbuffer != 0 && each.renderbuffer == renderbuffer);
  });
}

std::vector<GLuint> DeferredDepth::take_cleared(GLuint framebuffer, const std::optional<volume::Rect>& part) {
  return take_if([&](const Watched& each) {
    return each.framebuffer == framebuffer && (!part || intersection(*part, each.pixels) == each.pixels);
  });
}

std::vector<GLuint> DeferredDepth::take_textures(std::optional<GLuint> but_of) {
  return take_if([&](const Watched& each) { return each.in_texture && each.framebuffer != but_of; });
}

}  // namespace understudy::spu
