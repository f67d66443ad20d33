// SPDX-License-Identifier: Apache-2.0
#include "spu/track/track.h"

#include <span>
#include <tuple>

#include "dispatch/pass_through.h"
#include "spu/track/call_names.h"
#include "spu/track/calls.h"
#include "spu/track/program_slots.h"
#include "spu/track/state.h"

namespace understudy::spu {
namespace {

/// Within glNewList: records the kind of each command in the list, then lets the driver compile it.
struct NoteListContent {
  [[gnu::noinline]] static const DispatchTable& before(CallId call) {
    Track& track = Track::current();
    ListRecord& list = track.open_list();
    switch (kind_of(call)) {
      case CallKind::draw:
        list.draws = true;
        list.only_polygons &= call == CallId::End;
        break;
      case CallKind::bound_texture:
      case CallKind::unknown_texture:
        list.changes_textures = true;
        list.only_geometry = false;
        break;
      case CallKind::other:
        list.only_geometry = false;
        break;
      case CallKind::vertex:
      case CallKind::not_compiled:
        break;
    }
    return track.below();
  }
};

/// The same for draws whose first argument is the primitive mode.
template <auto Slot>
struct NotesMode;
template <class... A, void (APIENTRY* DispatchTable::*Slot)(GLenum, A...)>
struct NotesMode<Slot> {
  static void APIENTRY call(GLenum mode, A... rest) {
    Track& track = Track::current();
    track.open_list().draws = true;
    track.open_list().only_polygons &= draws_polygons(mode);
    (track.below().*Slot)(mode, rest...);
  }
};

struct TellOfTextureChange {
  static constexpr bool chooses(std::string_view name) { return changes_texture(name); }
  static const DispatchTable& before(CallId) {
    Track& track = Track::current();
    track.texture_changes();
    return track.below();
  }
};

/// Commands that define a 3-D texture if the argument at `Target` is GL_TEXTURE_3D (GL_PROXY_TEXTURE_3D is only
/// a query).
template <std::size_t Target, auto Slot>
struct DefinesVolume;
template <std::size_t Target, class... A, void (APIENTRY* DispatchTable::*Slot)(A...)>
struct DefinesVolume<Target, Slot> {
  static void APIENTRY call(A... arguments) {
    Track& track = Track::current();
    track.texture_changes();
    if (std::get<Target>(std::tie(arguments...)) == GL_TEXTURE_3D) track.volume_defined();
    (track.below().*Slot)(arguments...);
  }
};

void APIENTRY texture_storage_3d(GLuint texture, GLsizei levels, GLenum internal_format, GLsizei width,
                                 GLsizei height, GLsizei depth) {
  Track& track = Track::current();
  track.texture_changes();
  // If it is an array of 2-D textures, draws are watched needlessly.
  track.volume_defined();
  track.below().TextureStorage3D(texture, levels, internal_format, width, height, depth);
}

/// From now on the contents of both textures change together.
void APIENTRY texture_view(GLuint texture, GLenum target, GLuint original, GLenum internal_format,
                           GLuint first_level, GLuint levels, GLuint first_layer, GLuint layers) {
  Track& track = Track::current();
  track.texture_rendered_to(texture);
  track.texture_rendered_to(original);
  track.below().TextureView(texture, target, original, internal_format, first_level, levels, first_layer,
                            layers);
}

void APIENTRY delete_textures(GLsizei count, const GLuint* textures) {
  Track& track = Track::current();
  // The slices of an open run still need the texture.
  if (track.chain().phase() == Phase::deferring) track.chain().settle();
  if (count > 0 && textures != nullptr) {
    for (const GLuint texture : std::span(textures, std::size_t(count)))
      track.chain().group().texture_deleted(texture);
  }
  track.below().DeleteTextures(count, textures);
}

/// Commands that attach the texture in the argument at `Position` to a framebuffer.
template <std::size_t Position, auto Slot>
struct Attaches;
template <std::size_t Position, class... A, void (APIENTRY* DispatchTable::*Slot)(A...)>
struct Attaches<Position, Slot> {
  static void APIENTRY call(A... arguments) {
    Track& track = Track::current();
    track.texture_rendered_to(std::get<Position>(std::tie(arguments...)));
    (track.below().*Slot)(arguments...);
  }
};

void fill_attachments(DispatchTable& table) {
  using Table = DispatchTable;
  table.FramebufferTexture = Attaches<2, &Table::FramebufferTexture>::call;
  table.FramebufferTextureARB = Attaches<2, &Table::FramebufferTextureARB>::call;
  table.FramebufferTextureEXT = Attaches<2, &Table::FramebufferTextureEXT>::call;
  table.FramebufferTexture1D = Attaches<3, &Table::FramebufferTexture1D>::call;
  table.FramebufferTexture1DEXT = Attaches<3, &Table::FramebufferTexture1DEXT>::call;
  table.FramebufferTexture2D = Attaches<3, &Table::FramebufferTexture2D>::call;
  table.FramebufferTexture2DEXT = Attaches<3, &Table::FramebufferTexture2DEXT>::call;
  table.FramebufferTexture3D = Attaches<3, &Table::FramebufferTexture3D>::call;
  table.FramebufferTexture3DEXT = Attaches<3, &Table::FramebufferTexture3DEXT>::call;
  table.FramebufferTextureLayer = Attaches<2, &Table::FramebufferTextureLayer>::call;
  table.FramebufferTextureLayerARB = Attaches<2, &Table::FramebufferTextureLayerARB>::call;
  table.FramebufferTextureLayerEXT = Attaches<2, &Table::FramebufferTextureLayerEXT>::call;
  table.NamedFramebufferTexture = Attaches<2, &Table::NamedFramebufferTexture>::call;
  table.NamedFramebufferTextureEXT = Attaches<2, &Table::NamedFramebufferTextureEXT>::call;
  table.NamedFramebufferTexture1DEXT = Attaches<3, &Table::NamedFramebufferTexture1DEXT>::call;
  table.NamedFramebufferTexture2DEXT = Attaches<3, &Table::NamedFramebufferTexture2DEXT>::call;
  table.NamedFramebufferTexture3DEXT = Attaches<3, &Table::NamedFramebufferTexture3DEXT>::call;
  table.NamedFramebufferTextureLayer = Attaches<2, &Table::NamedFramebufferTextureLayer>::call;
  table.NamedFramebufferTextureLayerEXT = Attaches<2, &Table::NamedFramebufferTextureLayerEXT>::call;
}

void APIENTRY bind_image_texture(GLuint unit, GLuint texture, GLint level, GLboolean layered, GLint layer,
                                 GLenum access, GLenum format) {
  Track& track = Track::current();
  if (access != GL_READ_ONLY) track.texture_rendered_to(texture);
  track.below().BindImageTexture(unit, texture, level, layered, layer, access, format);
}

/// Binds textures for reading and writing.
void APIENTRY bind_image_textures(GLuint first, GLsizei count, const GLuint* textures) {
  Track& track = Track::current();
  if (count > 0 && textures != nullptr) {
    for (const GLuint texture : std::span(textures, std::size_t(count))) track.texture_rendered_to(texture);
  }
  track.below().BindImageTextures(first, count, textures);
}

void APIENTRY new_list(GLuint list, GLenum mode) {
  Track& track = Track::current();
  track.below().NewList(list, mode);
  // Other arguments are rejected, and no list is opened.
  if (list != 0 && (mode == GL_COMPILE || mode == GL_COMPILE_AND_EXECUTE))
    track.chain().after_call([&] { track.begin_list(list, mode); });
}

void APIENTRY close_list() {
  Track& track = Track::current();
  track.below().EndList();
  track.chain().after_call([&] { track.end_list(); });
}

void APIENTRY delete_lists(GLuint first, GLsizei count) {
  Track& track = Track::current();
  track.below().DeleteLists(first, count);
  track.chain().after_call([&] { track.chain().group().lists_deleted(first, count); });
}

void APIENTRY track_list(GLuint list) {
  Track& track = Track::current();
  track.below().CallList(list);
  ShareGroup& group = track.chain().group();
  if (!group.has_volumes() || !group.lists_change_textures()) return;
  track.chain().after_call([&] {
    const auto record = group.list(list);
    if (record && record->changes_textures) group.some_texture_changed();
  });
}

void APIENTRY call_lists(GLsizei count, GLenum type, const void* lists) {
  Track& track = Track::current();
  track.below().CallLists(count, type, lists);
  track.chain().after_call([&] {
    if (track.chain().group().lists_change_textures()) track.chain().group().some_texture_changed();
  });
}

void APIENTRY call_list_in_list(GLuint list) {
  Track& track = Track::current();
  const auto record = track.chain().group().list(list);
  ListRecord& open = track.open_list();
  open.draws |= !record || record->draws;
  open.only_geometry &= record && record->only_geometry;
  open.only_polygons &= record && record->only_polygons;
  open.changes_textures |= record && record->changes_textures;
  track.below().CallList(list);
}

/// Which lists are called depends on glListBase when the open list is executed.
void APIENTRY call_lists_in_list(GLsizei count, GLenum type, const void* lists) {
  Track& track = Track::current();
  ListRecord& open = track.open_list();
  open.draws = true;
  open.only_geometry = false;
  open.only_polygons = false;
  open.changes_textures |= track.chain().group().lists_change_textures();
  track.below().CallLists(count, type, lists);
}

void fill_compiling(DispatchTable& table) {
  const DispatchTable next = table;
  PassThrough<NoteListContent>::fill(table);
  for (std::size_t i = 0; i < call_count; ++i) {
    if (kind_of(CallId(i)) == CallKind::not_compiled) set_slot(table, CallId(i), slot(next, CallId(i)));
  }
  table.Begin = NotesMode<&DispatchTable::Begin>::call;
  table.DrawArrays = NotesMode<&DispatchTable::DrawArrays>::call;
  table.DrawElements = NotesMode<&DispatchTable::DrawElements>::call;
  table.DrawRangeElements = NotesMode<&DispatchTable::DrawRangeElements>::call;
  table.MultiDrawArrays = NotesMode<&DispatchTable::MultiDrawArrays>::call;
  table.MultiDrawElements = NotesMode<&DispatchTable::MultiDrawElements>::call;
  table.CallList = call_list_in_list;
  table.CallLists = call_lists_in_list;
  table.EndList = close_list;
}

void fill_texture_changes(DispatchTable& table) {
  PassThrough<TellOfTextureChange>::fill_chosen(table);
  table.TexImage3D = DefinesVolume<0, &DispatchTable::TexImage3D>::call;
  table.TexImage3DEXT = DefinesVolume<0, &DispatchTable::TexImage3DEXT>::call;
  table.TexStorage3D = DefinesVolume<0, &DispatchTable::TexStorage3D>::call;
  table.TextureImage3DEXT = DefinesVolume<1, &DispatchTable::TextureImage3DEXT>::call;
  table.TextureStorage3DEXT = DefinesVolume<1, &DispatchTable::TextureStorage3DEXT>::call;
  table.MultiTexImage3DEXT = DefinesVolume<1, &DispatchTable::MultiTexImage3DEXT>::call;
  table.TextureStorage3D = texture_storage_3d;
}

}  // namespace

void Track::begin_list(GLuint list, GLenum mode) {
  list_ = list;
  list_is_executed_ = mode == GL_COMPILE_AND_EXECUTE;
  open_list_ = {};
  phase_before_list_ = chain_.phase();
  chain_.set_phase(Phase::compiling);
}

void Track::end_list() {
  if (list_ != 0) chain_.group().list_defined(list_, open_list_);
  if (list_is_executed_ && open_list_.changes_textures) chain_.group().some_texture_changed();
  list_ = 0;
  chain_.set_phase(phase_before_list_);
}

void Track::texture_changes() {
  // Without volumes it does not matter which texture changes. In the watching phase, units record it.
  if (chain_.group().has_volumes()) chain_.set_phase(Phase::watching);
}

void Track::volume_defined() {
  chain_.group().volume_defined();
  if (chain_.phase() == Phase::plain) chain_.set_phase(Phase::watching);
}

void Track::texture_rendered_to(GLuint texture) {
  ShareGroup& group = chain_.group();
  if (const std::uint64_t deletions = group.deletions(); deletions != deletions_) {
    rendered_to_.fill(0);
    deletions_ = deletions;
  }
  GLuint& told = rendered_to_[texture % rendered_to_.size()];
  if (texture == told) return;
  if (texture != 0) group.texture_rendered_to(texture);
  told = texture;
}

void Track::made_current() {
  // At the first make-current the viewport takes the window's size, and another drawable has other buffers.
  if (!answers_) return;
  answers_->changed(topic::everything);
  answers_->perhaps_inside_begin();
}

void Track::frame_ended(FrameEnd) {
  if (chain_.phase() == Phase::plain && chain_.group().has_volumes()) chain_.set_phase(Phase::watching);
}

State Track::state() const {
  return read_state(below());
}

void Track::fill(Phase phase, DispatchTable& table) {
  if (!answers_) return fill_own(phase, table);
  const DispatchTable next = table;
  fill_own(phase, table);
  answers_->fill(phase, table, next);
}

void Track::fill_own(Phase phase, DispatchTable& table) {
  if (phase == Phase::compiling) fill_compiling(table);
  if (phase == Phase::plain) fill_texture_changes(table);
  fill_program_slots(table);
  fill_attachments(table);
  table.BindImageTexture = bind_image_texture;
  table.BindImageTextures = bind_image_textures;
  table.TextureView = texture_view;
  table.DeleteTextures = delete_textures;
  table.DeleteLists = delete_lists;
  if (phase == Phase::compiling) return;
  table.NewList = new_list;
  table.CallList = track_list;
  table.CallLists = call_lists;
}

}  // namespace understudy::spu
