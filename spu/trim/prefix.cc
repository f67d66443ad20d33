// SPDX-License-Identifier: Apache-2.0
#include "spu/trim/prefix.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "spu/stream/answers.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"
#include "spu/track/calls.h"

namespace understudy::spu {
namespace {

bool is_sub(std::string_view name) {
  return name.find("Sub") != std::string_view::npos;
}

GLenum buffer_binding(GLenum target) {
  switch (target) {
    case GL_ARRAY_BUFFER:
      return GL_ARRAY_BUFFER_BINDING;
    case GL_ELEMENT_ARRAY_BUFFER:
      return GL_ELEMENT_ARRAY_BUFFER_BINDING;
    case GL_UNIFORM_BUFFER:
      return GL_UNIFORM_BUFFER_BINDING;
    case GL_PIXEL_UNPACK_BUFFER:
      return GL_PIXEL_UNPACK_BUFFER_BINDING;
    default:
      return GL_NONE;
  }
}

/// The same of all targets to which glCopyBufferSubData() can copy.
GLenum binding_for_copies(GLenum target) {
  switch (target) {
    case GL_COPY_READ_BUFFER:
      return GL_COPY_READ_BUFFER_BINDING;
    case GL_COPY_WRITE_BUFFER:
      return GL_COPY_WRITE_BUFFER_BINDING;
    case GL_PIXEL_PACK_BUFFER:
      return GL_PIXEL_PACK_BUFFER_BINDING;
    case GL_TEXTURE_BUFFER:
      return GL_TEXTURE_BUFFER_BINDING;
    case GL_TRANSFORM_FEEDBACK_BUFFER:
      return GL_TRANSFORM_FEEDBACK_BUFFER_BINDING;
    case GL_SHADER_STORAGE_BUFFER:
      return GL_SHADER_STORAGE_BUFFER_BINDING;
    case GL_ATOMIC_COUNTER_BUFFER:
      return GL_ATOMIC_COUNTER_BUFFER_BINDING;
    case GL_DRAW_INDIRECT_BUFFER:
      return GL_DRAW_INDIRECT_BUFFER_BINDING;
    case GL_DISPATCH_INDIRECT_BUFFER:
      return GL_DISPATCH_INDIRECT_BUFFER_BINDING;
    case GL_QUERY_BUFFER:
      return GL_QUERY_BUFFER_BINDING;
    default:
      return buffer_binding(target);
  }
}

/// The faces of a cube map are images of one texture.
GLenum texture_target(GLenum image_target) {
  const bool face =
      image_target >= GL_TEXTURE_CUBE_MAP_POSITIVE_X && image_target <= GL_TEXTURE_CUBE_MAP_NEGATIVE_Z;
  return face ? GL_TEXTURE_CUBE_MAP : image_target;
}

std::int64_t signed_word(std::uint64_t word) {
  return std::int32_t(word);
}

}  // namespace

GLenum texture_binding(GLenum target) {
  switch (texture_target(target)) {
    case GL_TEXTURE_1D:
      return GL_TEXTURE_BINDING_1D;
    case GL_TEXTURE_2D:
      return GL_TEXTURE_BINDING_2D;
    case GL_TEXTURE_3D:
      return GL_TEXTURE_BINDING_3D;
    case GL_TEXTURE_RECTANGLE:
      return GL_TEXTURE_BINDING_RECTANGLE;
    case GL_TEXTURE_CUBE_MAP:
      return GL_TEXTURE_BINDING_CUBE_MAP;
    case GL_TEXTURE_1D_ARRAY:
      return GL_TEXTURE_BINDING_1D_ARRAY;
    case GL_TEXTURE_2D_ARRAY:
      return GL_TEXTURE_BINDING_2D_ARRAY;
    default:
      return GL_NONE;
  }
}

GLuint Prefix::ask(GLenum name) const {
  GLint value = 0;
  player_.driver().GetIntegerv(name, &value);
  return GLuint(value);
}

StreamObject& Prefix::stream_object(ObjectKind kind, GLuint here) {
  return objects_.try_emplace({player_.current().group, kind, here}, StreamObject{here}).first->second;
}

void Prefix::mark(ObjectKind kind, GLuint here) {
  if (here != 0) drawn_[{player_.current().group, kind, here}] = stream_object(kind, here);
}

void Prefix::mark_bound_texture(GLenum target) {
  if (const GLenum binding = texture_binding(target); binding != GL_NONE)
    mark(ObjectKind::texture, ask(binding));
}

void Prefix::mark_attachments() {
  const DispatchTable& gl = player_.driver();
  if (gl.GetFramebufferAttachmentParameteriv == nullptr) return;
  const GLuint framebuffer = ask(GL_DRAW_FRAMEBUFFER_BINDING);
  const std::tuple now(player_.current().number, framebuffer);
  if (framebuffer == 0 || now == framebuffer_seen_) return;
  framebuffer_seen_ = now;
  const GLuint colours = std::min(ask(GL_MAX_COLOR_ATTACHMENTS), 16U);
  for (GLuint i = 0; i < colours + 2; ++i) {
    const GLenum attachment = i < colours    ? GL_COLOR_ATTACHMENT0 + i
                              : i == colours ? GLenum(GL_DEPTH_ATTACHMENT)
                                             : GLenum(GL_STENCIL_ATTACHMENT);
    GLint type = GL_NONE;
    GLint name = 0;
    gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment,
                                           GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, &type);
    if (type != GL_TEXTURE && type != GL_RENDERBUFFER) continue;
    gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment,
                                           GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME, &name);
    mark(type == GL_TEXTURE ? ObjectKind::texture : ObjectKind::renderbuffer, GLuint(name));
  }
}

RecordAction Prefix::action_of_event(const Record& record, const ThreadState& thread) const {
  switch (record.id) {
    case event::frame:
      return RecordAction::drop;
    case event::arrays:
    case event::arrays_end:
      return thread.compiling ? RecordAction::keep : RecordAction::drop;
    case event::answers:
      return thread.last_call == RecordAction::drop ? RecordAction::drop : RecordAction::keep;
    default:
      return RecordAction::keep;
  }
}

RecordAction Prefix::action_of_call(CallId call, const Record& record, ThreadState& thread) {
  if (call == CallId::NewList) thread.compiling = true;
  if (call == CallId::EndList) thread.compiling = false;
  if (thread.compiling || call == CallId::EndList) return RecordAction::keep;
  switch (role_of(call)) {
    case CallRole::begin:
      thread.inside_begin = true;
      thread.attributes.clear();
      return RecordAction::drop;
    case CallRole::end:
      thread.inside_begin = false;
      return RecordAction::drop;
    case CallRole::attribute: {
      if (!thread.inside_begin) return RecordAction::keep;
      // Attributes of different texture units or indices differ in the first argument.
      const std::string_view name = call_name(call);
      const bool numbered = name.starts_with("glMulti") || name.starts_with("glVertexAttrib");
      const std::pair key(record.id, numbered && record.words.size() > 1 ? record.words[1] : 0);
      const auto [found, first] = thread.attributes.try_emplace(key, actions_.size());
      if (!first) {
        actions_[found->second] = RecordAction::drop;
        found->second = actions_.size();
      }
      return RecordAction::keep;
    }
    case CallRole::vertex:
    case CallRole::draw:
    case CallRole::read:
    case CallRole::ask:
      return RecordAction::drop;
    case CallRole::call_list:
      return RecordAction::expand;
    case CallRole::state:
      return RecordAction::keep;
  }
  return RecordAction::keep;
}

namespace {

/// The word of the call's argument at `place`; 0 if the record is too short.
std::uint64_t word_at(const Record& record, std::size_t place) {
  return place + 1 < record.words.size() ? record.words[place + 1] : 0;
}

}  // namespace

/// Marks the objects that OpenGL is about to write to. Must not be called between glBegin and glEnd.
void Prefix::look_before(CallId call, const Record& record, const ThreadState& thread) {
  const std::string_view name = call_name(call);
  switch (role_of(call)) {
    case CallRole::draw:
    case CallRole::begin:
    case CallRole::call_list:
      mark_attachments();
      break;
    case CallRole::read:
      mark(ObjectKind::buffer, ask(GL_PIXEL_PACK_BUFFER_BINDING));
      break;
    default:
      break;
  }
  if (name.find("Framebuffer") != std::string_view::npos || name.starts_with("glDelete") ||
      role_of(call) == CallRole::call_list) {
    framebuffer_seen_ = {};
  }
  // A list that is being compiled reads the current contents of buffers: their earlier uploads are kept.
  if (thread.compiling && kind_of(call) == CallKind::draw) {
    std::erase_if(uploads_, [](const auto& entry) { return std::get<1>(entry.first) == ObjectKind::buffer; });
  }
  look_at_texture(call, record);
  look_at_buffer(call, record);
  note_upload(call, record);
}

void Prefix::look_at_texture(CallId call, const Record& record) {
  const std::string_view name = call_name(call);
  const auto word = [&](std::size_t p) { return word_at(record, p); };
  if (name.starts_with("glCopyTexImage") || name.starts_with("glCopyTexSubImage") ||
      name.starts_with("glGenerateMipmap")) {
    mark_bound_texture(GLenum(word(0)));
  }
  // The target of a texture can be queried in core profiles only.
  if (call == CallId::BindTexture || call == CallId::BindTextureEXT)
    stream_object(ObjectKind::texture, GLuint(player_.here(ObjectKind::texture, word(1)))).target =
        GLenum(word(0));
  if (call == CallId::CreateTextures) last_created_ = GLenum(word(0));
  const std::uint8_t access = argument_named(call_shape(call), "access");
  if (call == CallId::BindImageTexture && access != no_argument && word(access) != GL_READ_ONLY)
    mark(ObjectKind::texture, GLuint(player_.here(ObjectKind::texture, word(1))));
  if (name == "glGenerateTextureMipmap" || name.starts_with("glCopyTextureSubImage") ||
      name.starts_with("glClearTex"))
    mark(ObjectKind::texture, GLuint(player_.here(ObjectKind::texture, word(0))));
  if (call == CallId::CopyImageSubData && word(7) != GL_RENDERBUFFER)
    mark(ObjectKind::texture, GLuint(player_.here(ObjectKind::texture, word(6))));
}

void Prefix::look_at_buffer(CallId call, const Record& record) {
  const auto word = [&](std::size_t p) { return word_at(record, p); };
  if ((call == CallId::BindBufferBase || call == CallId::BindBufferRange) && word(0) != GL_UNIFORM_BUFFER)
    mark(ObjectKind::buffer, GLuint(player_.here(ObjectKind::buffer, word(2))));
  if (call == CallId::CopyNamedBufferSubData)
    mark(ObjectKind::buffer, GLuint(player_.here(ObjectKind::buffer, word(1))));
  if (call == CallId::CopyBufferSubData) {
    GLint buffer = 0;
    const GLenum binding = binding_for_copies(GLenum(word(1)));
    if (binding != GL_NONE) player_.driver().GetIntegerv(binding, &buffer);
    mark(ObjectKind::buffer, GLuint(buffer));
  }
}

void Prefix::supersede(const Image& image, const Upload& upload) {
  std::vector<Upload>& earlier = uploads_[image];
  std::erase_if(earlier, [&](const Upload& old) {
    bool covered = true;
    for (std::size_t k = 0; k < 3; ++k)
      covered &= upload.box[k] <= old.box[k] && old.box[k + 3] <= upload.box[k + 3];
    if (!upload.makes_room && !covered) return false;
    actions_[old.record] = old.makes_room ? RecordAction::keep_without_data : RecordAction::drop;
    return true;
  });
  earlier.push_back(upload);
}

void Prefix::note_upload(CallId call, const Record& record) {
  const std::string_view name = call_name(call);
  const CallShape& shape = call_shape(call);
  const auto word = [&](std::size_t p) { return p + 1 < record.words.size() ? record.words[p + 1] : 0; };
  const auto argument = [&](const char* of, std::int64_t otherwise) {
    const std::uint8_t at = argument_named(shape, of);
    return at == no_argument ? otherwise : signed_word(word(at));
  };
  const auto data_kind = [&](const char* of) {
    const std::uint8_t at = argument_named(shape, of);
    return at == no_argument ? ReferenceKind::null : Reference::from(word(at)).kind;
  };
  const std::uint64_t group = player_.current().group;
  if (kind_of(call) == CallKind::bound_texture && !name.starts_with("glCopyTex") &&
      !name.starts_with("glTexStorage")) {
    const auto target = GLenum(word(0));
    const GLenum binding = texture_binding(target);
    if (binding == GL_NONE) return;
    const GLuint texture = ask(binding);
    const ReferenceKind kind = data_kind(name.starts_with("glCompressed") ? "data" : "pixels");
    // When the stream is played later, the buffer would have other contents.
    if (kind == ReferenceKind::address) mark(ObjectKind::texture, texture);
    Upload upload{.record = actions_.size(), .makes_room = !is_sub(name)};
    const std::array<std::int64_t, 3> first = {argument("xoffset", 0), argument("yoffset", 0),
                                               argument("zoffset", 0)};
    const std::array<std::int64_t, 3> size = {argument("width", 1), argument("height", 1),
                                              argument("depth", 1)};
    for (std::size_t k = 0; k < 3; ++k) {
      upload.box[k] = first[k];
      upload.box[k + 3] = first[k] + size[k];
    }
    supersede({group, ObjectKind::texture, texture, target, GLint(argument("level", 0))}, upload);
    return;
  }
  const bool buffer_data = call == CallId::BufferData || call == CallId::BufferDataARB;
  const bool buffer_part = call == CallId::BufferSubData || call == CallId::BufferSubDataARB;
  if (!buffer_data && !buffer_part) return;
  const GLenum binding = buffer_binding(GLenum(word(0)));
  if (binding == GL_NONE) return;
  Upload upload{.record = actions_.size(), .makes_room = buffer_data};
  upload.box = {buffer_data ? 0 : std::int64_t(word(1)), 0, 0, 0, 1, 1};
  upload.box[3] = buffer_data ? std::int64_t(word(1)) : std::int64_t(word(1) + word(2));
  supersede({group, ObjectKind::buffer, ask(binding), 0, 0}, upload);
}

/// Records the answers of the thread's last call: names in the stream and local names.
void Prefix::note_answers(const Record& record) {
  const auto arguments = record.arguments();
  const auto call = arguments.empty() ? std::nullopt : find_stable_id(std::uint32_t(arguments[0]));
  if (!call) return;
  std::size_t at = 2;
  for (const ParameterShape& parameter : call_shape(*call).parameters()) {
    if (!answers_names(parameter)) continue;
    const auto names = at < arguments.size() ? record.bytes(arguments[at++]) : std::nullopt;
    if (!names) return;
    for (std::size_t i = 0; i + sizeof(GLuint) <= names->size(); i += sizeof(GLuint)) {
      GLuint there = 0;
      std::memcpy(&there, names->data() + i, sizeof there);
      const auto here = GLuint(player_.here(parameter.object, there));
      stream_object(parameter.object, here).name = there;
      if (*call == CallId::CreateTextures) stream_object(parameter.object, here).target = last_created_;
    }
  }
}

std::string Prefix::play(const Record& record) {
  if (record.id == event::thread && record.words.size() > 1) thread_ = record.words[1];
  ThreadState& thread = threads_[thread_];
  const auto call = find_stable_id(record.id);
  RecordAction action = RecordAction::keep;
  if (!call) {
    action = action_of_event(record, thread);
  } else {
    const bool prepared = !thread.inside_begin && player_.prepare();
    if (prepared) look_before(*call, record, thread);
    action = action_of_call(*call, record, thread);
    thread.last_call = action;
  }
  actions_.push_back(action);
  std::string error = player_.play(record);
  if (record.id == event::answers) note_answers(record);
  return error;
}

}  // namespace understudy::spu
