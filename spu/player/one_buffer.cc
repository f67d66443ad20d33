// SPDX-License-Identifier: Apache-2.0
#include "spu/player/one_buffer.h"

#include <algorithm>
#include <array>

namespace understudy::spu {
namespace {

/// The driver and the format of this thread's current context.
struct Current {
  const DispatchTable* driver = nullptr;
  bool double_buffered = false;
};
thread_local Current current;

GLenum name_below(GLenum buffer) {
  if (!current.double_buffered) return buffer;
  if (buffer == GL_BACK) return GL_FRONT;
  return buffer == GL_BACK_LEFT ? GLenum(GL_FRONT_LEFT) : buffer;
}

GLenum name_above(GLenum buffer) {
  if (buffer == GL_FRONT) return GL_BACK;
  return buffer == GL_FRONT_LEFT ? GLenum(GL_BACK_LEFT) : buffer;
}

bool holds_a_buffer(GLenum name) {
  return name == GL_DRAW_BUFFER || name == GL_READ_BUFFER ||
         (name >= GL_DRAW_BUFFER0 && name <= GL_DRAW_BUFFER15);
}

GLuint bound_framebuffer(GLenum target) {
  GLint bound = 0;
  const bool read = target == GL_READ_FRAMEBUFFER;
  current.driver->GetIntegerv(read ? GL_READ_FRAMEBUFFER_BINDING : GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  return GLuint(bound);
}

/// Calls `ask(values)` and replaces buffer names in its results. `framebuffer()` is the framebuffer that is
/// queried.
template <class Value, class Ask, class Framebuffer>
void answer(GLenum name, Value* values, const Ask& ask, const Framebuffer& framebuffer) {
  if (!current.double_buffered || (name != GL_DOUBLEBUFFER && !holds_a_buffer(name))) return ask(values);
  // A query that fails must leave the application's memory unchanged.
  constexpr auto unanswered = Value(0x55);
  Value value = unanswered;
  ask(&value);
  if (value == unanswered) return;
  if (name == GL_DOUBLEBUFFER) {
    *values = framebuffer() == 0 ? Value(GL_TRUE) : value;
  } else {
    *values = sizeof value == sizeof(GLboolean) ? value : Value(name_above(GLenum(value)));
  }
}

template <class Value>
using Getter = void(APIENTRY*)(GLenum, Value*);

}  // namespace

struct OneBuffer::Slots {
  template <void (APIENTRY* DispatchTable::*call)(GLenum)>
  static void APIENTRY name(GLenum buffer) {
    (current.driver->*call)(name_below(buffer));
  }

  template <void (APIENTRY* DispatchTable::*call)(GLuint, GLenum)>
  static void APIENTRY named(GLuint framebuffer, GLenum buffer) {
    (current.driver->*call)(framebuffer, name_below(buffer));
  }

  /// Lists contain single buffers; GL_BACK is only allowed as the only entry, and means the left back buffer.
  template <class Call>
  static void with_list(GLsizei count, const GLenum* buffers, const Call& call) {
    std::array<GLenum, GL_DRAW_BUFFER15 - GL_DRAW_BUFFER0 + 1> below{};
    if (!current.double_buffered || count < 1 || count > GLsizei(below.size())) return call(buffers);
    std::transform(buffers, buffers + count, below.begin(), [count](GLenum buffer) {
      if (buffer == GL_BACK) return count == 1 ? GLenum(GL_FRONT_LEFT) : buffer;
      return name_below(buffer);
    });
    call(below.data());
  }

  template <void (APIENTRY* DispatchTable::*call)(GLsizei, const GLenum*)>
  static void APIENTRY list(GLsizei count, const GLenum* buffers) {
    with_list(count, buffers, [count](const GLenum* below) { (current.driver->*call)(count, below); });
  }

  template <void (APIENTRY* DispatchTable::*call)(GLuint, GLsizei, const GLenum*)>
  static void APIENTRY named_list(GLuint framebuffer, GLsizei count, const GLenum* buffers) {
    with_list(count, buffers, [=](const GLenum* below) { (current.driver->*call)(framebuffer, count, below); });
  }

  template <void (APIENTRY* DispatchTable::*call)(GLenum, GLenum, GLenum, GLint*)>
  static void APIENTRY attachment(GLenum target, GLenum buffer, GLenum what, GLint* values) {
    (current.driver->*call)(target, name_below(buffer), what, values);
  }

  template <void (APIENTRY* DispatchTable::*call)(GLuint, GLenum, GLenum, GLint*)>
  static void APIENTRY named_attachment(GLuint framebuffer, GLenum buffer, GLenum what, GLint* values) {
    (current.driver->*call)(framebuffer, name_below(buffer), what, values);
  }

  template <class Value, Getter<Value> DispatchTable::*call>
  static void APIENTRY get(GLenum name, Value* values) {
    answer(
        name, values, [name](Value* into) { (current.driver->*call)(name, into); },
        [] { return bound_framebuffer(GL_DRAW_FRAMEBUFFER); });
  }

  template <void (APIENTRY* DispatchTable::*call)(GLenum, GLenum, GLint*)>
  static void APIENTRY parameter(GLenum target, GLenum name, GLint* values) {
    answer(
        name, values, [=](GLint* into) { (current.driver->*call)(target, name, into); },
        [target] { return bound_framebuffer(target); });
  }

  template <void (APIENTRY* DispatchTable::*call)(GLuint, GLenum, GLint*)>
  static void APIENTRY named_parameter(GLuint framebuffer, GLenum name, GLint* values) {
    answer(
        name, values, [=](GLint* into) { (current.driver->*call)(framebuffer, name, into); },
        [framebuffer] { return framebuffer; });
  }
};

OneBuffer::OneBuffer(const DispatchTable& driver) : driver_(driver), table_(driver) {
  // Functions that the driver lacks stay null.
  const auto put = [](auto& slot, auto function) {
    if (slot != nullptr) slot = function;
  };
  using T = DispatchTable;
  put(table_.DrawBuffer, Slots::name<&T::DrawBuffer>);
  put(table_.ReadBuffer, Slots::name<&T::ReadBuffer>);
  put(table_.NamedFramebufferDrawBuffer, Slots::named<&T::NamedFramebufferDrawBuffer>);
  put(table_.NamedFramebufferReadBuffer, Slots::named<&T::NamedFramebufferReadBuffer>);
  put(table_.FramebufferDrawBufferEXT, Slots::named<&T::FramebufferDrawBufferEXT>);
  put(table_.FramebufferReadBufferEXT, Slots::named<&T::FramebufferReadBufferEXT>);
  put(table_.DrawBuffers, Slots::list<&T::DrawBuffers>);
  put(table_.DrawBuffersARB, Slots::list<&T::DrawBuffersARB>);
  put(table_.DrawBuffersATI, Slots::list<&T::DrawBuffersATI>);
  put(table_.NamedFramebufferDrawBuffers, Slots::named_list<&T::NamedFramebufferDrawBuffers>);
  put(table_.FramebufferDrawBuffersEXT, Slots::named_list<&T::FramebufferDrawBuffersEXT>);
  put(table_.GetFramebufferAttachmentParameteriv, Slots::attachment<&T::GetFramebufferAttachmentParameteriv>);
  put(table_.GetFramebufferAttachmentParameterivEXT,
      Slots::attachment<&T::GetFramebufferAttachmentParameterivEXT>);
  put(table_.GetNamedFramebufferAttachmentParameteriv,
      Slots::named_attachment<&T::GetNamedFramebufferAttachmentParameteriv>);
  put(table_.GetNamedFramebufferAttachmentParameterivEXT,
      Slots::named_attachment<&T::GetNamedFramebufferAttachmentParameterivEXT>);
  put(table_.GetIntegerv, Slots::get<GLint, &T::GetIntegerv>);
  put(table_.GetBooleanv, Slots::get<GLboolean, &T::GetBooleanv>);
  put(table_.GetFloatv, Slots::get<GLfloat, &T::GetFloatv>);
  put(table_.GetDoublev, Slots::get<GLdouble, &T::GetDoublev>);
  put(table_.GetInteger64v, Slots::get<GLint64, &T::GetInteger64v>);
  put(table_.GetFramebufferParameteriv, Slots::parameter<&T::GetFramebufferParameteriv>);
  put(table_.GetNamedFramebufferParameteriv, Slots::named_parameter<&T::GetNamedFramebufferParameteriv>);
  put(table_.GetNamedFramebufferParameterivEXT, Slots::named_parameter<&T::GetNamedFramebufferParameterivEXT>);
  put(table_.GetFramebufferParameterivEXT, Slots::named_parameter<&T::GetFramebufferParameterivEXT>);
}

OneBuffer::~OneBuffer() {
  if (current.driver == &driver_) current = {};
}

void OneBuffer::made_current(bool double_buffered) {
  current = {&driver_, double_buffered};
}

}  // namespace understudy::spu
