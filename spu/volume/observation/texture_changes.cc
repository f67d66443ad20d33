// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/texture_changes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "dispatch/pass_through.h"
#include "spu/track/call_names.h"
#include "spu/track/calls.h"
#include "spu/track/share_group.h"
#include "spu/volume/observation/draw_observer.h"
#include "volume/texel_box.h"

namespace understudy::spu {
namespace {

/// Reports that the textures of `dimensions` dimensions bound to the active unit are about to change.
void bound_textures_change(DrawObserver& observer, int dimensions) {
  constexpr std::array<std::array<GLenum, 2>, 3> bindings = {
      {{GL_TEXTURE_BINDING_1D, 0},
       {GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_RECTANGLE},
       {GL_TEXTURE_BINDING_3D, 0}}};
  for (const GLenum binding : bindings[std::size_t(dimensions - 1)]) {
    GLint texture = 0;
    if (binding != 0) observer.context().gl->GetIntegerv(binding, &texture);
    if (texture != 0) observer.chain().group().texture_changed(GLuint(texture));
  }
}

struct NoteTextureChange {
  static constexpr bool chooses(std::string_view name) { return changes_texture(name); }
  static const DispatchTable& before(CallId call) {
    DrawObserver& observer = DrawObserver::current();
    if (kind_of(call) == CallKind::bound_texture && !observer.inside_begin) {
      bound_textures_change(observer, texture_dimensions(call));
    } else {
      observer.chain().group().some_texture_changed();
    }
    return observer.next();
  }
};

/// Notes a change once more after the call: another context of the group may have read the old texels while the
/// driver made it, and has stored them under the version of before.
template <class Note>
void note_again(const Note& note) {
  DrawObserver::current().chain().after_call(note);
}

/// Commands on the bound texture.
template <CallId Id, auto Slot>
struct ChangesBoundTexture;
template <CallId Id, class... A, void (APIENTRY* DispatchTable::*Slot)(A...)>
struct ChangesBoundTexture<Id, Slot> {
  static void APIENTRY call(A... arguments) {
    (NoteTextureChange::before(Id).*Slot)(arguments...);
    note_again([] { NoteTextureChange::before(Id); });
  }
};

/// Direct state access commands identify the texture by their first argument.
template <auto Slot>
struct ChangesNamedTexture;
template <class... A, void (APIENTRY* DispatchTable::*Slot)(GLuint, A...)>
struct ChangesNamedTexture<Slot> {
  static void APIENTRY call(GLuint texture, A... arguments) {
    DrawObserver& observer = DrawObserver::current();
    observer.chain().group().texture_changed(texture);
    (observer.next().*Slot)(texture, arguments...);
    note_again([&] { observer.chain().group().texture_changed(texture); });
  }
};

/// Returns the box of an upload; empty if its sizes are invalid, and nothing is uploaded.
volume::TexelBox box_of(GLint x, GLint y, GLint z, GLsizei width, GLsizei height, GLsizei depth) {
  const auto end = [](GLint low, GLsizei extent) {
    return int(std::clamp<std::int64_t>(std::int64_t(low) + extent, low, std::numeric_limits<int>::max()));
  };
  return {{x, y, z}, {end(x, width), end(y, height), end(z, depth)}};
}

/// Reports that a box of one level of the texture bound to `target` is about to change.
void bound_box_changes(GLenum target, GLint level, const volume::TexelBox& box) {
  DrawObserver& observer = DrawObserver::current();
  GLint texture = 0;
  if (target == GL_TEXTURE_3D && level == 0 && !observer.inside_begin)
    observer.context().gl->GetIntegerv(GL_TEXTURE_BINDING_3D, &texture);
  if (texture != 0) {
    observer.chain().group().texture_changed(GLuint(texture), box);
  } else {
    NoteTextureChange::before(CallId::TexSubImage3D);
  }
}

void named_box_changes(GLuint texture, GLint level, const volume::TexelBox& box) {
  ShareGroup& group = DrawObserver::current().chain().group();
  if (level == 0) {
    group.texture_changed(texture, box);
  } else {
    group.texture_changed(texture);
  }
}

void APIENTRY tex_sub_image_3d(GLenum target, GLint level, GLint x, GLint y, GLint z, GLsizei width,
                               GLsizei height, GLsizei depth, GLenum format, GLenum type, const void* pixels) {
  bound_box_changes(target, level, box_of(x, y, z, width, height, depth));
  DrawObserver::current().next().TexSubImage3D(target, level, x, y, z, width, height, depth, format, type,
                                               pixels);
  note_again([&] { bound_box_changes(target, level, box_of(x, y, z, width, height, depth)); });
}

void APIENTRY copy_tex_sub_image_3d(GLenum target, GLint level, GLint x, GLint y, GLint z, GLint from_x,
                                    GLint from_y, GLsizei width, GLsizei height) {
  bound_box_changes(target, level, box_of(x, y, z, width, height, 1));
  DrawObserver::current().next().CopyTexSubImage3D(target, level, x, y, z, from_x, from_y, width, height);
  note_again([&] { bound_box_changes(target, level, box_of(x, y, z, width, height, 1)); });
}

void APIENTRY texture_sub_image_3d(GLuint texture, GLint level, GLint x, GLint y, GLint z, GLsizei width,
                                   GLsizei height, GLsizei depth, GLenum format, GLenum type,
                                   const void* pixels) {
  named_box_changes(texture, level, box_of(x, y, z, width, height, depth));
  DrawObserver::current().next().TextureSubImage3D(texture, level, x, y, z, width, height, depth, format, type,
                                                   pixels);
  note_again([&] { named_box_changes(texture, level, box_of(x, y, z, width, height, depth)); });
}

void APIENTRY copy_texture_sub_image_3d(GLuint texture, GLint level, GLint x, GLint y, GLint z, GLint from_x,
                                        GLint from_y, GLsizei width, GLsizei height) {
  named_box_changes(texture, level, box_of(x, y, z, width, height, 1));
  DrawObserver::current().next().CopyTextureSubImage3D(texture, level, x, y, z, from_x, from_y, width, height);
  note_again([&] { named_box_changes(texture, level, box_of(x, y, z, width, height, 1)); });
}

void APIENTRY clear_tex_sub_image(GLuint texture, GLint level, GLint x, GLint y, GLint z, GLsizei width,
                                  GLsizei height, GLsizei depth, GLenum format, GLenum type,
                                  const void* value) {
  named_box_changes(texture, level, box_of(x, y, z, width, height, depth));
  DrawObserver::current().next().ClearTexSubImage(texture, level, x, y, z, width, height, depth, format, type,
                                                  value);
  note_again([&] { named_box_changes(texture, level, box_of(x, y, z, width, height, depth)); });
}

/// A copy changes only its destination. Its box is as large as the source's, or smaller if the source is
/// compressed; a compressed destination is not a volume. Renderbuffers are not textures.
template <auto Slot>
void APIENTRY copy_image(GLuint from, GLenum from_target, GLint from_level, GLint from_x, GLint from_y,
                         GLint from_z, GLuint to, GLenum to_target, GLint to_level, GLint x, GLint y, GLint z,
                         GLsizei width, GLsizei height, GLsizei depth) {
  const auto note = [&] {
    if (to_target == GL_TEXTURE_3D) {
      named_box_changes(to, to_level, box_of(x, y, z, width, height, depth));
    } else if (to_target != GL_RENDERBUFFER) {
      DrawObserver::current().chain().group().texture_changed(to);
    }
  };
  note();
  (DrawObserver::current().next().*Slot)(from, from_target, from_level, from_x, from_y, from_z, to, to_target,
                                         to_level, x, y, z, width, height, depth);
  note_again(note);
}

}  // namespace

void fill_texture_change_slots(DispatchTable& table) {
  PassThrough<NoteTextureChange>::fill_chosen(table);
  using Table = DispatchTable;
  table.TextureStorage1D = ChangesNamedTexture<&Table::TextureStorage1D>::call;
  table.TextureStorage2D = ChangesNamedTexture<&Table::TextureStorage2D>::call;
  table.TextureStorage3D = ChangesNamedTexture<&Table::TextureStorage3D>::call;
  table.TextureSubImage1D = ChangesNamedTexture<&Table::TextureSubImage1D>::call;
  table.TextureSubImage2D = ChangesNamedTexture<&Table::TextureSubImage2D>::call;
  table.TextureSubImage3D = texture_sub_image_3d;
  table.CopyTextureSubImage3D = copy_texture_sub_image_3d;
  table.TexImage1D = ChangesBoundTexture<CallId::TexImage1D, &Table::TexImage1D>::call;
  table.TexImage2D = ChangesBoundTexture<CallId::TexImage2D, &Table::TexImage2D>::call;
  table.TexImage3D = ChangesBoundTexture<CallId::TexImage3D, &Table::TexImage3D>::call;
  table.TexSubImage1D = ChangesBoundTexture<CallId::TexSubImage1D, &Table::TexSubImage1D>::call;
  table.TexSubImage2D = ChangesBoundTexture<CallId::TexSubImage2D, &Table::TexSubImage2D>::call;
  table.TexSubImage3D = tex_sub_image_3d;
  table.CopyTexSubImage3D = copy_tex_sub_image_3d;
  table.ClearTexImage = ChangesNamedTexture<&Table::ClearTexImage>::call;
  table.ClearTexSubImage = clear_tex_sub_image;
  table.CopyImageSubData = copy_image<&Table::CopyImageSubData>;
  table.CopyImageSubDataNV = copy_image<&Table::CopyImageSubDataNV>;
}

}  // namespace understudy::spu
