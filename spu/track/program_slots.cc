// SPDX-License-Identifier: Apache-2.0
#include "spu/track/program_slots.h"

#include <span>

#include "spu/track/track.h"

namespace understudy::spu {
namespace {

ProgramSources& programs() {
  return Track::current().chain().group().programs();
}

/// Records what a call did, after the call was made.
template <class Note>
void note(Note note) {
  Track::current().chain().after_call([&] { note(programs()); });
}

GLuint APIENTRY create_shader(GLenum type) {
  const GLuint shader = Track::current().below().CreateShader(type);
  note([&](ProgramSources& known) { known.shader_created(shader, type); });
  return shader;
}

GLhandleARB APIENTRY create_shader_object(GLenum type) {
  const GLhandleARB shader = Track::current().below().CreateShaderObjectARB(type);
  note([&](ProgramSources& known) { known.shader_created(GLuint(shader), type); });
  return shader;
}

GLuint APIENTRY create_program() {
  const GLuint program = Track::current().below().CreateProgram();
  note([&](ProgramSources& known) { known.program_created(program); });
  return program;
}

GLhandleARB APIENTRY create_program_object() {
  const GLhandleARB program = Track::current().below().CreateProgramObjectARB();
  note([&](ProgramSources& known) { known.program_created(GLuint(program)); });
  return program;
}

GLuint APIENTRY create_shader_program(GLenum type, GLsizei count, const GLchar* const* strings) {
  const GLuint program = Track::current().below().CreateShaderProgramv(type, count, strings);
  note([&](ProgramSources& known) {
    known.program_linked_from(program, type, joined(count, strings, nullptr));
  });
  return program;
}

GLuint APIENTRY create_shader_program_ext(GLenum type, const GLchar* string) {
  const GLuint program = Track::current().below().CreateShaderProgramEXT(type, string);
  note([&](ProgramSources& known) { known.program_linked_from(program, type, joined(1, &string, nullptr)); });
  return program;
}

void APIENTRY shader_source(GLuint shader, GLsizei count, const GLchar* const* strings, const GLint* lengths) {
  programs().source_given(shader, joined(count, strings, lengths));
  Track::current().below().ShaderSource(shader, count, strings, lengths);
}

void APIENTRY shader_source_arb(GLhandleARB shader, GLsizei count, const GLcharARB** strings,
                                const GLint* lengths) {
  programs().source_given(GLuint(shader), joined(count, strings, lengths));
  Track::current().below().ShaderSourceARB(shader, count, strings, lengths);
}

void APIENTRY shader_binary(GLsizei count, const GLuint* shaders, GLenum format, const void* binary,
                            GLsizei length) {
  if (count > 0 && shaders != nullptr) {
    for (const GLuint shader : std::span(shaders, std::size_t(count))) programs().binary_given(shader);
  }
  Track::current().below().ShaderBinary(count, shaders, format, binary, length);
}

void APIENTRY specialize_shader(GLuint shader, const GLchar* entry, GLuint count, const GLuint* indices,
                                const GLuint* values) {
  programs().binary_given(shader);
  Track::current().below().SpecializeShader(shader, entry, count, indices, values);
}

void APIENTRY specialize_shader_arb(GLuint shader, const GLchar* entry, GLuint count, const GLuint* indices,
                                    const GLuint* values) {
  programs().binary_given(shader);
  Track::current().below().SpecializeShaderARB(shader, entry, count, indices, values);
}

void APIENTRY program_binary(GLuint program, GLenum format, const void* binary, GLsizei length) {
  Track::current().below().ProgramBinary(program, format, binary, length);
  if (binary == nullptr || length <= 0) return;
  note([&](ProgramSources& known) {
    known.program_loaded(program, {static_cast<const std::byte*>(binary), std::size_t(length)});
  });
}

void APIENTRY get_program_binary(GLuint program, GLsizei space, GLsizei* length, GLenum* format, void* binary) {
  constexpr GLsizei nothing_written = -1;
  GLsizei written = nothing_written;
  Track::current().below().GetProgramBinary(program, space, &written, format, binary);
  if (length != nullptr && written != nothing_written) *length = written;
  if (binary == nullptr || written <= 0) return;
  note([&](ProgramSources& known) {
    known.binary_taken(program, {static_cast<const std::byte*>(binary), std::size_t(written)});
  });
}

void APIENTRY delete_object(GLhandleARB object) {
  Track::current().below().DeleteObjectARB(object);
  // A shader and a program never have the same name.
  note([&](ProgramSources& known) {
    known.shader_deleted(GLuint(object));
    known.program_deleted(GLuint(object));
  });
}

/// Commands that take one or two object names and return nothing: the call is made, then recorded.
template <auto Slot, auto Note>
struct Noted;
template <class... Names, void (APIENTRY* DispatchTable::*Slot)(Names...), auto Note>
struct Noted<Slot, Note> {
  static void APIENTRY call(Names... names) {
    (Track::current().below().*Slot)(names...);
    note([&](ProgramSources& known) { (known.*Note)(GLuint(names)...); });
  }
};

}  // namespace

void fill_program_slots(DispatchTable& table) {
  table.CreateShader = create_shader;
  table.CreateShaderObjectARB = create_shader_object;
  table.CreateProgram = create_program;
  table.CreateProgramObjectARB = create_program_object;
  table.CreateShaderProgramv = create_shader_program;
  table.CreateShaderProgramEXT = create_shader_program_ext;
  table.ShaderSource = shader_source;
  table.ShaderSourceARB = shader_source_arb;
  table.ShaderBinary = shader_binary;
  table.SpecializeShader = specialize_shader;
  table.SpecializeShaderARB = specialize_shader_arb;
  table.ProgramBinary = program_binary;
  table.GetProgramBinary = get_program_binary;
  table.DeleteObjectARB = delete_object;
  using Table = DispatchTable;
  using Sources = ProgramSources;
  table.CompileShader = Noted<&Table::CompileShader, &Sources::shader_compiled>::call;
  table.CompileShaderARB = Noted<&Table::CompileShaderARB, &Sources::shader_compiled>::call;
  table.AttachShader = Noted<&Table::AttachShader, &Sources::shader_attached>::call;
  table.AttachObjectARB = Noted<&Table::AttachObjectARB, &Sources::shader_attached>::call;
  table.DetachShader = Noted<&Table::DetachShader, &Sources::shader_detached>::call;
  table.DetachObjectARB = Noted<&Table::DetachObjectARB, &Sources::shader_detached>::call;
  table.LinkProgram = Noted<&Table::LinkProgram, &Sources::program_linked>::call;
  table.LinkProgramARB = Noted<&Table::LinkProgramARB, &Sources::program_linked>::call;
  table.DeleteShader = Noted<&Table::DeleteShader, &Sources::shader_deleted>::call;
  table.DeleteProgram = Noted<&Table::DeleteProgram, &Sources::program_deleted>::call;
}

}  // namespace understudy::spu
