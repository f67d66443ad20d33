#include "spu/track/track.h"

#include <array>
#include <span>

#include "dispatch/pass_through.h"
#include "spu/track/calls.h"

namespace understudy::spu {
namespace {

Track& here() {
  return *Chain::current()->find<Track>();
}

/// Inside glNewList: notes what kind of command the list takes up, then lets the driver compile it.
struct NoteListContent {
  static const DispatchTable& before(CallId call) {
    Track& track = here();
    ListRecord& list = track.open_list();
    switch (kind_of(call)) {
      case CallKind::draw:
        list.draws = true;
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

/// A texture changes: what was deferred is drawn first, with the old contents.
struct NoteTextureChange {
  static const DispatchTable& before(CallId call) {
    Track& track = here();
    track.chain().settle();
    if (kind_of(call) == CallKind::bound_texture) {
      track.bound_textures_change(texture_dimensions(call));
    } else {
      track.chain().group().all_textures_changed();
    }
    return track.below();
  }
};

/// Commands of direct state access name the texture in their first argument.
template <auto Slot>
struct ChangesNamedTexture;
template <class... A, void (APIENTRY* DispatchTable::*Slot)(GLuint, A...)>
struct ChangesNamedTexture<Slot> {
  static void APIENTRY call(GLuint texture, A... arguments) {
    Track& track = here();
    track.chain().settle();
    track.chain().group().texture_changed(texture);
    (track.below().*Slot)(texture, arguments...);
  }
};

/// 3-D textures are what draws are watched for: the first one changes the phase of the stream.
void note_volume(Track& track, GLuint texture) {
  ShareGroup& group = track.chain().group();
  group.texture_changed(texture);
  group.volume_defined(texture);
  if (track.chain().phase() == Phase::plain) track.chain().set_phase(Phase::watching);
}

GLuint bound_volume(const DispatchTable& gl) {
  GLint texture = 0;
  gl.GetIntegerv(GL_TEXTURE_BINDING_3D, &texture);
  return GLuint(texture);
}

void APIENTRY tex_image_3d(GLenum target, GLint level, GLint internal_format, GLsizei width, GLsizei height,
                           GLsizei depth, GLint border, GLenum format, GLenum type, const void* pixels) {
  Track& track = here();
  track.chain().settle();
  // PROXY_TEXTURE_3D is a question, not an upload.
  if (target == GL_TEXTURE_3D) note_volume(track, bound_volume(track.chain().driver()));
  track.below().TexImage3D(target, level, internal_format, width, height, depth, border, format, type, pixels);
}

void APIENTRY tex_image_3d_ext(GLenum target, GLint level, GLenum internal_format, GLsizei width,
                               GLsizei height, GLsizei depth, GLint border, GLenum format, GLenum type,
                               const void* pixels) {
  tex_image_3d(target, level, GLint(internal_format), width, height, depth, border, format, type, pixels);
}

void APIENTRY tex_storage_3d(GLenum target, GLsizei levels, GLenum internal_format, GLsizei width,
                             GLsizei height, GLsizei depth) {
  Track& track = here();
  track.chain().settle();
  if (target == GL_TEXTURE_3D) note_volume(track, bound_volume(track.chain().driver()));
  track.below().TexStorage3D(target, levels, internal_format, width, height, depth);
}

void APIENTRY texture_storage_3d(GLuint texture, GLsizei levels, GLenum internal_format, GLsizei width,
                                 GLsizei height, GLsizei depth) {
  Track& track = here();
  track.chain().settle();
  note_volume(track, texture);
  track.below().TextureStorage3D(texture, levels, internal_format, width, height, depth);
}

void APIENTRY delete_textures(GLsizei count, const GLuint* textures) {
  Track& track = here();
  track.chain().settle();
  if (count > 0 && textures != nullptr) {
    for (const GLuint texture : std::span(textures, std::size_t(count)))
      track.chain().group().texture_deleted(texture);
  }
  track.below().DeleteTextures(count, textures);
}

void APIENTRY framebuffer_texture(GLenum target, GLenum attachment, GLuint texture, GLint level) {
  Track& track = here();
  track.chain().group().texture_rendered_to(texture);
  track.below().FramebufferTexture(target, attachment, texture, level);
}

void APIENTRY framebuffer_texture_1d(GLenum target, GLenum attachment, GLenum texture_target, GLuint texture,
                                     GLint level) {
  Track& track = here();
  track.chain().group().texture_rendered_to(texture);
  track.below().FramebufferTexture1D(target, attachment, texture_target, texture, level);
}

void APIENTRY framebuffer_texture_3d(GLenum target, GLenum attachment, GLenum texture_target, GLuint texture,
                                     GLint level, GLint layer) {
  Track& track = here();
  track.chain().group().texture_rendered_to(texture);
  track.below().FramebufferTexture3D(target, attachment, texture_target, texture, level, layer);
}

void APIENTRY framebuffer_texture_layer(GLenum target, GLenum attachment, GLuint texture, GLint level,
                                        GLint layer) {
  Track& track = here();
  track.chain().group().texture_rendered_to(texture);
  track.below().FramebufferTextureLayer(target, attachment, texture, level, layer);
}

void APIENTRY bind_image_texture(GLuint unit, GLuint texture, GLint level, GLboolean layered, GLint layer,
                                 GLenum access, GLenum format) {
  Track& track = here();
  if (access != GL_READ_ONLY) track.chain().group().texture_rendered_to(texture);
  track.below().BindImageTexture(unit, texture, level, layered, layer, access, format);
}

/// Reads back what a program was linked from while its shaders are still attached.
ProgramRecord describe_program(const DispatchTable& gl, GLuint program) {
  ProgramRecord record;
  GLint linked = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (!linked) return record;
  std::array<GLuint, 16> shaders{};
  GLsizei attached = 0;
  gl.GetAttachedShaders(program, GLsizei(shaders.size()), &attached, shaders.data());
  for (GLsizei i = 0; i < attached; ++i) {
    GLint type = 0;
    GLint length = 0;
    gl.GetShaderiv(shaders[i], GL_SHADER_TYPE, &type);
    gl.GetShaderiv(shaders[i], GL_SHADER_SOURCE_LENGTH, &length);
    std::string source(std::size_t(std::max(length, 1)), '\0');
    GLsizei written = 0;
    gl.GetShaderSource(shaders[i], GLsizei(source.size()), &written, source.data());
    source.resize(std::size_t(written));
    if (type == GL_VERTEX_SHADER) {
      record.vertex_shader = true;
      record.vertex_sources.push_back(std::move(source));
    } else if (type == GL_FRAGMENT_SHADER) {
      record.fragment_source_known = !source.empty();
      record.fragment_sources.push_back(std::move(source));
    } else {
      record.other_stages = true;
    }
  }
  GLint uniforms = 0;
  gl.GetProgramiv(program, GL_ACTIVE_UNIFORMS, &uniforms);
  for (GLint i = 0; i < uniforms; ++i) {
    std::array<char, 256> name{};
    GLint size = 0;
    GLenum type = 0;
    gl.GetActiveUniform(program, GLuint(i), GLsizei(name.size()), nullptr, &size, &type, name.data());
    if (type == GL_SAMPLER_1D || type == GL_SAMPLER_2D || type == GL_SAMPLER_3D || type == GL_SAMPLER_2D_RECT) {
      record.samplers.push_back({name.data(), type, gl.GetUniformLocation(program, name.data())});
    }
  }
  return record;
}

void APIENTRY link_program(GLuint program) {
  Track& track = here();
  track.below().LinkProgram(program);
  track.chain().group().program_linked(program, describe_program(track.chain().driver(), program));
}

void APIENTRY link_program_arb(GLhandleARB program) {
  Track& track = here();
  track.below().LinkProgramARB(program);
  const auto name = GLuint(program);
  track.chain().group().program_linked(name, describe_program(track.chain().driver(), name));
}

void APIENTRY delete_program(GLuint program) {
  Track& track = here();
  track.below().DeleteProgram(program);
  track.chain().group().program_deleted(program);
}

void APIENTRY new_list(GLuint list, GLenum mode) {
  Track& track = here();
  track.below().NewList(list, mode);
  GLint open = 0;
  track.chain().driver().GetIntegerv(GL_LIST_INDEX, &open);
  if (open != 0) track.begin_list(GLuint(open));
}

void APIENTRY close_list() {
  Track& track = here();
  track.below().EndList();
  track.end_list();
}

void APIENTRY delete_lists(GLuint first, GLsizei count) {
  Track& track = here();
  track.below().DeleteLists(first, count);
  track.chain().group().lists_deleted(first, count);
}

void APIENTRY call_list(GLuint list) {
  Track& track = here();
  const auto record = track.chain().group().list(list);
  track.below().CallList(list);
  if (record && record->changes_textures) track.chain().group().all_textures_changed();
}

void APIENTRY call_list_in_list(GLuint list) {
  Track& track = here();
  const auto record = track.chain().group().list(list);
  ListRecord& open = track.open_list();
  open.draws |= !record || record->draws;
  open.only_geometry &= record && record->only_geometry;
  open.changes_textures |= record && record->changes_textures;
  track.below().CallList(list);
}

}  // namespace

void Track::begin_list(GLuint list) {
  list_ = list;
  open_list_ = {};
  phase_before_list_ = chain_.phase();
  chain_.set_phase(Phase::compiling);
}

void Track::end_list() {
  if (list_ != 0) chain_.group().list_defined(list_, open_list_);
  list_ = 0;
  chain_.set_phase(phase_before_list_);
}

void Track::frame_ended(FrameEnd) {
  if (chain_.phase() == Phase::plain && chain_.group().has_volumes()) chain_.set_phase(Phase::watching);
}

void Track::bound_textures_change(int dimensions) {
  constexpr std::array<std::array<GLenum, 2>, 3> bindings = {
      {{GL_TEXTURE_BINDING_1D, 0},
       {GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_RECTANGLE},
       {GL_TEXTURE_BINDING_3D, 0}}};
  for (const GLenum binding : bindings[std::size_t(dimensions - 1)]) {
    GLint texture = 0;
    if (binding != 0) chain_.driver().GetIntegerv(binding, &texture);
    if (texture != 0) chain_.group().texture_changed(GLuint(texture));
  }
}

void Track::fill(Phase phase, DispatchTable& table) {
  if (phase == Phase::compiling) {
    const DispatchTable driver = table;
    PassThrough<NoteListContent>::fill(table);
    // Nothing that is executed at once needs noting; the texture calls among it are overridden below.
    for (std::size_t i = 0; i < call_count; ++i) {
      if (kind_of(CallId(i)) == CallKind::not_compiled) set_slot(table, CallId(i), slot(driver, CallId(i)));
    }
    table.CallList = call_list_in_list;
    table.EndList = close_list;
    return;
  }
  DispatchTable texture_changes = table;
  PassThrough<NoteTextureChange>::fill(texture_changes);
  for (std::size_t i = 0; i < call_count; ++i) {
    const CallKind kind = kind_of(CallId(i));
    if (kind == CallKind::bound_texture || kind == CallKind::unknown_texture) {
      set_slot(table, CallId(i), slot(texture_changes, CallId(i)));
    }
  }
  table.TexImage3D = tex_image_3d;
  table.TexImage3DEXT = tex_image_3d_ext;
  table.TexStorage3D = tex_storage_3d;
  table.TextureStorage3D = texture_storage_3d;
  table.TextureStorage1D = ChangesNamedTexture<&DispatchTable::TextureStorage1D>::call;
  table.TextureStorage2D = ChangesNamedTexture<&DispatchTable::TextureStorage2D>::call;
  table.TextureSubImage1D = ChangesNamedTexture<&DispatchTable::TextureSubImage1D>::call;
  table.TextureSubImage2D = ChangesNamedTexture<&DispatchTable::TextureSubImage2D>::call;
  table.TextureSubImage3D = ChangesNamedTexture<&DispatchTable::TextureSubImage3D>::call;
  table.ClearTexImage = ChangesNamedTexture<&DispatchTable::ClearTexImage>::call;
  table.ClearTexSubImage = ChangesNamedTexture<&DispatchTable::ClearTexSubImage>::call;
  table.DeleteTextures = delete_textures;
  table.FramebufferTexture = framebuffer_texture;
  table.FramebufferTexture1D = framebuffer_texture_1d;
  table.FramebufferTexture3D = framebuffer_texture_3d;
  table.FramebufferTextureLayer = framebuffer_texture_layer;
  table.BindImageTexture = bind_image_texture;
  table.LinkProgram = link_program;
  table.LinkProgramARB = link_program_arb;
  table.DeleteProgram = delete_program;
  table.NewList = new_list;
  table.DeleteLists = delete_lists;
  table.CallList = call_list;
}

}  // namespace understudy::spu
