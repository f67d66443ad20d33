// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/stack_detection.h"

#include "spu/volume/observation/draw_observer.h"

namespace understudy::spu {
namespace {

/// This many consecutive textures of one size may be a volume; those with smaller edges are glyphs and icons.
constexpr int suspicious_length = 16;
constexpr GLsizei smallest_edge = 16;

void defined(DrawObserver& observer, GLenum target, GLint level, GLsizei width, GLsizei height) {
  if (target != GL_TEXTURE_2D || level != 0 || !observer.stacks.detection.continues(width, height)) return;
  observer.chain().after_call([&] {
    GLint texture = 0;
    observer.next().GetIntegerv(GL_TEXTURE_BINDING_2D, &texture);
    if (observer.stacks.detection.add(GLuint(texture))) observer.stack_defined();
  });
}

void APIENTRY tex_image_2d(GLenum target, GLint level, GLint internal_format, GLsizei width, GLsizei height,
                           GLint border, GLenum format, GLenum type, const void* pixels) {
  DrawObserver& observer = DrawObserver::current();
  const DispatchTable& next = observer.next();
  next.TexImage2D(target, level, internal_format, width, height, border, format, type, pixels);
  defined(observer, target, level, width, height);
}

void APIENTRY tex_storage_2d(GLenum target, GLsizei levels, GLenum internal_format, GLsizei width,
                             GLsizei height) {
  DrawObserver& observer = DrawObserver::current();
  observer.next().TexStorage2D(target, levels, internal_format, width, height);
  defined(observer, target, 0, width, height);
}
}  // namespace

bool StackDetection::continues(GLsizei width, GLsizei height) {
  const bool same = width == width_ && height == height_;
  if (!same) {
    width_ = width;
    height_ = height;
    last_ = 0;
    length_ = 1;
  }
  return same && width >= smallest_edge && height >= smallest_edge;
}

bool StackDetection::add(GLuint texture) {
  // The images of a film are uploaded to one texture, one after the other.
  if (texture == last_) return false;
  last_ = texture;
  return ++length_ == suspicious_length;
}

void fill_stack_detection_slots(DispatchTable& table) {
  table.TexImage2D = tex_image_2d;
  table.TexStorage2D = tex_storage_2d;
}

}  // namespace understudy::spu
