#include "spu/volume/texture_changes.h"

#include <array>

#include "dispatch/pass_through.h"
#include "spu/track/calls.h"
#include "spu/track/share_group.h"
#include "spu/volume/volume_unit.h"

namespace understudy::spu {
namespace {

VolumeUnit& here() {
  return *Chain::current()->find<VolumeUnit>();
}

/// The textures of `dimensions` dimensions bound to the active unit are about to change.
void bound_textures_change(VolumeUnit& unit, int dimensions) {
  constexpr std::array<std::array<GLenum, 2>, 3> bindings = {
      {{GL_TEXTURE_BINDING_1D, 0},
       {GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_RECTANGLE},
       {GL_TEXTURE_BINDING_3D, 0}}};
  for (const GLenum binding : bindings[std::size_t(dimensions - 1)]) {
    GLint texture = 0;
    if (binding != 0) unit.context().gl->GetIntegerv(binding, &texture);
    if (texture != 0) unit.chain().group().texture_changed(GLuint(texture));
  }
}

struct NoteTextureChange {
  static const DispatchTable& before(CallId call) {
    VolumeUnit& unit = here();
    if (kind_of(call) == CallKind::bound_texture && !unit.inside_begin) {
      bound_textures_change(unit, texture_dimensions(call));
    } else {
      unit.chain().group().some_texture_changed();
    }
    return unit.next();
  }
};

/// Commands of direct state access name the texture in their first argument.
template <auto Slot>
struct ChangesNamedTexture;
template <class... A, void (APIENTRY* DispatchTable::*Slot)(GLuint, A...)>
struct ChangesNamedTexture<Slot> {
  static void APIENTRY call(GLuint texture, A... arguments) {
    VolumeUnit& unit = here();
    unit.chain().group().texture_changed(texture);
    (unit.next().*Slot)(texture, arguments...);
  }
};

}  // namespace

void fill_texture_change_slots(DispatchTable& table) {
  DispatchTable changes = table;
  PassThrough<NoteTextureChange>::fill(changes);
  for (std::size_t i = 0; i < call_count; ++i) {
    const CallKind kind = kind_of(CallId(i));
    if (kind == CallKind::bound_texture || kind == CallKind::unknown_texture) {
      set_slot(table, CallId(i), slot(changes, CallId(i)));
    }
  }
  using Table = DispatchTable;
  table.TextureStorage1D = ChangesNamedTexture<&Table::TextureStorage1D>::call;
  table.TextureStorage2D = ChangesNamedTexture<&Table::TextureStorage2D>::call;
  table.TextureStorage3D = ChangesNamedTexture<&Table::TextureStorage3D>::call;
  table.TextureSubImage1D = ChangesNamedTexture<&Table::TextureSubImage1D>::call;
  table.TextureSubImage2D = ChangesNamedTexture<&Table::TextureSubImage2D>::call;
  table.TextureSubImage3D = ChangesNamedTexture<&Table::TextureSubImage3D>::call;
  table.ClearTexImage = ChangesNamedTexture<&Table::ClearTexImage>::call;
  table.ClearTexSubImage = ChangesNamedTexture<&Table::ClearTexSubImage>::call;
}

}  // namespace understudy::spu
