// SPDX-License-Identifier: Apache-2.0
#include "spu/remote/front_buffer.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace understudy::spu {
namespace {

enum class Part : std::uint8_t {
  none,
  draws,
  draws_by_name,  ///< into the framebuffer that the call specifies
  follows,        ///< chooses buffers, or concerns lists, attributes or framebuffer objects
};

constexpr std::size_t attribute_stack_depth = 16;
constexpr std::string_view prefixes_of_front_draws[] = {
    "glBegin",           "glDrawArrays",   "glDrawElements", "glDrawRangeElements",
    "glDrawPixels",      "glDrawMesh",     "glDrawTex",      "glDrawTransform",
    "glMultiDraw",       "glMultiMode",    "glRect",         "glEvalMesh",
    "glBitmap",          "glCopyPixels",   "glAccum",        "glCallLists",
    "glBlitFramebuffer", "glDrawCommands", "glCoverFill",    "glCoverStroke",
    "glStencilThenCover"};
constexpr std::string_view clears[] = {"glClear", "glClearBufferiv", "glClearBufferuiv", "glClearBufferfv",
                                       "glClearBufferfi"};
constexpr std::string_view named_prefixes[] = {"glClearNamedFramebuffer", "glBlitNamedFramebuffer"};

bool starts_with_any(std::string_view name, const auto& prefixes) {
  return std::any_of(std::begin(prefixes), std::end(prefixes),
                     [&](std::string_view prefix) { return name.starts_with(prefix); });
}

Part part_of(CallId call) {
  switch (call) {
    case CallId::DrawBuffer:
    case CallId::DrawBuffers:
    case CallId::DrawBuffersARB:
    case CallId::DrawBuffersATI:
    case CallId::NamedFramebufferDrawBuffer:
    case CallId::NamedFramebufferDrawBuffers:
    case CallId::FramebufferDrawBufferEXT:
    case CallId::FramebufferDrawBuffersEXT:
    case CallId::BindFramebuffer:
    case CallId::BindFramebufferEXT:
    case CallId::DeleteFramebuffers:
    case CallId::DeleteFramebuffersEXT:
    case CallId::PushAttrib:
    case CallId::PopAttrib:
    case CallId::NewList:
    case CallId::EndList:
    case CallId::CallList:
    case CallId::DeleteLists:
      return Part::follows;
    default:
      break;
  }
  const std::string_view name = call_name(call);
  if (starts_with_any(name, named_prefixes)) return Part::draws_by_name;
  const bool draws = starts_with_any(name, prefixes_of_front_draws) ||
                     std::find(std::begin(clears), std::end(clears), name) != std::end(clears);
  return draws ? Part::draws : Part::none;
}

Part part(CallId call) {
  static const std::array<Part, call_count> parts = [] {
    std::array<Part, call_count> all{};
    for (std::size_t i = 0; i < call_count; ++i) all[i] = part_of(CallId(i));
    return all;
  }();
  return parts[std::size_t(call)];
}

template <class T>
const T* pointer(std::uint64_t word) {
  return reinterpret_cast<const T*>(static_cast<std::uintptr_t>(word));
}

}  // namespace

FrontBuffer::FrontBuffer(bool doubly_buffered, ShareGroup& lists)
    : doubly_buffered_(doubly_buffered), lists_(&lists) {
  calls_.record.leaves = doubly_buffered ? ChosenBuffer::other : ChosenBuffer::front;
}

ChosenBuffer FrontBuffer::buffer_of(GLenum name) const {
  switch (name) {
    case GL_FRONT:
    case GL_FRONT_LEFT:
    case GL_FRONT_AND_BACK:
    case GL_LEFT:
      return ChosenBuffer::front;
    case GL_NONE:
      return ChosenBuffer::other;
    default:
      // A single-buffered window has no other buffer.
      return doubly_buffered_ ? ChosenBuffer::other : ChosenBuffer::front;
  }
}

ChosenBuffer FrontBuffer::chosen_by(CallId call, const std::uint64_t* words) const {
  const auto any_of = [&](std::uint64_t count, std::uint64_t names) {
    const auto* first = pointer<GLenum>(names);
    for (GLsizei i = 0; i < GLsizei(count) && first != nullptr; ++i)
      if (buffer_of(first[i]) == ChosenBuffer::front) return ChosenBuffer::front;
    return ChosenBuffer::other;
  };
  switch (call) {
    case CallId::DrawBuffer:
      return window_is_bound() ? buffer_of(GLenum(words[0])) : ChosenBuffer::as_before;
    case CallId::DrawBuffers:
    case CallId::DrawBuffersARB:
    case CallId::DrawBuffersATI:
      return window_is_bound() ? any_of(words[0], words[1]) : ChosenBuffer::as_before;
    case CallId::NamedFramebufferDrawBuffer:
    case CallId::FramebufferDrawBufferEXT:
      return words[0] == 0 ? buffer_of(GLenum(words[1])) : ChosenBuffer::as_before;
    case CallId::NamedFramebufferDrawBuffers:
    case CallId::FramebufferDrawBuffersEXT:
      return words[0] == 0 ? any_of(words[1], words[2]) : ChosenBuffer::as_before;
    default:
      return ChosenBuffer::as_before;
  }
}

void FrontBuffer::draw(Calls& calls) const {
  if (calls.record.leaves == ChosenBuffer::front) calls.record.draws_front = true;
  if (calls.record.leaves == ChosenBuffer::as_before) calls.record.draws = true;
}

void FrontBuffer::choose(Calls& calls, ChosenBuffer buffer) const {
  if (buffer != ChosenBuffer::as_before) calls.record.leaves = buffer;
}

void FrontBuffer::call_list(Calls& calls, GLuint list) const {
  const auto known = lists_->list(list);
  if (!known) return draw(calls);
  if (known->draws) draw(calls);
  calls.record.draws_front |= known->draws_front;
  choose(calls, known->leaves);
}

void FrontBuffer::follow(CallId call, const std::uint64_t* words, Calls& calls) const {
  switch (call) {
    case CallId::PushAttrib:
      // Most drivers reject more than the 16 levels that OpenGL guarantees; a program may try every frame.
      if (calls.pushed.size() == attribute_stack_depth) return;
      calls.pushed.emplace_back(GLbitfield(words[0]), calls.record.leaves);
      return;
    case CallId::PopAttrib:
      if (calls.pushed.empty()) return;
      if ((calls.pushed.back().first & GL_COLOR_BUFFER_BIT) != 0 && window_is_bound())
        calls.record.leaves = calls.pushed.back().second;
      calls.pushed.pop_back();
      return;
    case CallId::CallList:
      if (window_is_bound()) call_list(calls, GLuint(words[0]));
      return;
    default:
      choose(calls, chosen_by(call, words));
  }
}

void FrontBuffer::bind(GLenum target, GLuint framebuffer) {
  if (target != GL_READ_FRAMEBUFFER) framebuffer_ = framebuffer;
}

void FrontBuffer::note(CallId call, const std::uint64_t* words) {
  const Part its = part(call);
  if (its == Part::none) return;
  switch (call) {
    case CallId::BindFramebuffer:
    case CallId::BindFramebufferEXT:
      return bind(GLenum(words[0]), GLuint(words[1]));
    case CallId::DeleteFramebuffers:
    case CallId::DeleteFramebuffersEXT: {
      const auto* names = pointer<GLuint>(words[1]);
      for (GLsizei i = 0; i < GLsizei(words[0]) && names != nullptr; ++i)
        if (names[i] == framebuffer_) framebuffer_ = 0;
      return;
    }
    case CallId::NewList:
      open_ = GLuint(words[0]);
      executes_ = GLenum(words[1]) == GL_COMPILE_AND_EXECUTE;
      open_list_ = {};
      return;
    case CallId::EndList:
      if (open_ != 0) lists_->list_defined(open_, open_list_.record);
      open_ = 0;
      return;
    case CallId::DeleteLists:
      return lists_->lists_deleted(GLuint(words[0]), GLsizei(words[1]));
    default:
      break;
  }
  const auto apply = [&](Calls& calls) {
    if (its == Part::follows) return follow(call, words, calls);
    // Both kinds of calls with an explicit framebuffer have the one that is drawn into as first or second
    // argument.
    const bool blit = call == CallId::BlitNamedFramebuffer;
    const bool window = its == Part::draws ? window_is_bound() : words[blit ? 1 : 0] == 0;
    if (window) draw(calls);
  };
  if (open_ != 0) apply(open_list_);
  if (open_ == 0 || executes_) apply(calls_);
}

bool FrontBuffer::is_left_by(CallId call, const std::uint64_t* words) const {
  if (calls_.record.leaves != ChosenBuffer::front || part(call) != Part::follows) return false;
  if (open_ != 0 && !executes_) return false;
  Calls after = calls_;
  follow(call, words, after);
  return after.record.leaves == ChosenBuffer::other;
}

}  // namespace understudy::spu
