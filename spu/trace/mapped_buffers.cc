// SPDX-License-Identifier: Apache-2.0
#include "spu/trace/mapped_buffers.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "spu/stream/answers.h"
#include "spu/stream/bound_buffers.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"
#include "spu/stream/mapping_calls.h"

namespace understudy::spu {
namespace {

void append_write(const std::byte* first, std::size_t offset, std::size_t bytes, Records& to) {
  to.begin(event::mapped_write);
  to.append(reinterpret_cast<std::uintptr_t>(first));
  to.append(offset);
  to.append(0);
  to.set(3, to.attach({first + offset, bytes}).word());
}

/// Calls that may make OpenGL read a buffer while it stays mapped.
bool may_read_buffers(CallId call) {
  const std::string_view name = call_name(call);
  return name.starts_with("glDraw") || name.starts_with("glMultiDraw") || name.starts_with("glDispatch") ||
         name.starts_with("glCopy") || name.starts_with("glTex") || name.starts_with("glMemoryBarrier") ||
         name.starts_with("glFenceSync") || name == "glFlush" || name == "glFinish" ||
         name.find("BufferSubData") != name.npos;
}

}  // namespace

MappedBuffers::Mapping* MappedBuffers::find(GLuint buffer) {
  const auto found =
      std::ranges::find_if(mappings_, [&](const Mapping& mapping) { return mapping.buffer == buffer; });
  return found == mappings_.end() ? nullptr : &*found;
}

void MappedBuffers::forget(GLuint buffer) {
  std::erase_if(mappings_, [&](const Mapping& mapping) { return mapping.buffer == buffer; });
}

bool MappedBuffers::is_mapped(const DispatchTable& gl, const Mapping& mapping) const {
  return memory_ == MappedMemory::of_this_process || mapping_of(gl, mapping.buffer).first == mapping.first;
}

void MappedBuffers::write_changes(Mapping& mapping, Records& to) {
  const auto now = std::span(mapping.first, mapping.bytes);
  const auto [changed, unused] = std::mismatch(now.begin(), now.end(), mapping.seen.begin());
  if (changed == now.end()) return;
  std::size_t last = mapping.bytes;
  while (now[last - 1] == mapping.seen[last - 1]) --last;
  const auto offset = std::size_t(changed - now.begin());
  append_write(mapping.first, offset, last - offset, to);
  std::copy(changed, now.begin() + std::ptrdiff_t(last), mapping.seen.begin() + std::ptrdiff_t(offset));
}

void MappedBuffers::before(const DispatchTable& gl, CallId call, const std::uint64_t* words, Records& to) {
  if (mappings_.empty()) return;
  if (deletes_buffers(call)) {
    for (const GLuint buffer : deleted_buffers(words)) forget(buffer);
  } else if (replaces_storage(call)) {
    const Mapping* const mapping = find(buffer_of(gl, call, words));
    if (mapping != nullptr && mapping->seen.empty()) forget(mapping->buffer);
  } else if (flushes_mapping(call)) {
    flush(gl, words, buffer_of(gl, call, words), to);
  } else if (unmaps_buffer(call)) {
    unmap(gl, buffer_of(gl, call, words), to);
  } else if (may_read_buffers(call)) {
    append_persistent(gl, to);
  }
}

void MappedBuffers::flush(const DispatchTable& gl, const std::uint64_t* words, GLuint buffer, Records& to) {
  const Mapping* const mapping = find(buffer);
  const auto offset = std::size_t(words[1]);
  const auto bytes = std::size_t(words[2]);
  if (mapping == nullptr || offset > mapping->bytes || bytes > mapping->bytes - offset) return;
  if (is_mapped(gl, *mapping)) append_write(mapping->first, offset, bytes, to);
}

void MappedBuffers::unmap(const DispatchTable& gl, GLuint buffer, Records& to) {
  Mapping* const mapping = find(buffer);
  if (mapping == nullptr) return;
  if (is_mapped(gl, *mapping)) {
    if (!mapping->seen.empty()) {
      write_changes(*mapping, to);
    } else if (!mapping->written_explicitly) {
      append_write(mapping->first, 0, mapping->bytes, to);
    }
  }
  forget(buffer);
}

void MappedBuffers::append_persistent(const DispatchTable& gl, Records& to) {
  std::erase_if(mappings_,
                [&](const Mapping& mapping) { return !mapping.seen.empty() && !is_mapped(gl, mapping); });
  for (Mapping& mapping : mappings_) {
    if (!mapping.seen.empty()) write_changes(mapping, to);
  }
}

bool MappedBuffers::refresh(GLuint buffer, std::span<const std::byte> contents) {
  Mapping* const mapping = find(buffer);
  if (mapping == nullptr || mapping->seen.empty()) return false;
  for (std::size_t i = 0; i < std::min(contents.size(), mapping->bytes); ++i) {
    if (contents[i] != mapping->seen[i]) mapping->seen[i] = mapping->first[i] = contents[i];
  }
  return true;
}

void MappedBuffers::after(const DispatchTable& gl, CallId call, const std::uint64_t* words,
                          std::uint64_t result) {
  if (!maps_a_buffer(call) || result == 0) return;
  const GLuint buffer = buffer_of(gl, call, words);
  forget(buffer);  // a mapping that has ended in another context
  const CallShape& shape = call_shape(call);
  const std::uint8_t access_at = argument_named(shape, "access");
  const std::uint8_t length_at = argument_named(shape, "length");
  const bool by_range = length_at != no_argument;
  const auto access = access_at == no_argument ? GLbitfield(0) : GLbitfield(words[access_at]);
  const bool writes = by_range ? (access & GL_MAP_WRITE_BIT) != 0 : access != GL_READ_ONLY;
  if (!writes) return;
  Mapping mapping{.buffer = buffer};
  mapping.first = reinterpret_cast<std::byte*>(static_cast<std::uintptr_t>(result));
  if (by_range) {
    mapping.bytes = std::size_t(words[length_at]);
  } else {
    GLint bytes = 0;
    if (is_by_name(call)) {
      gl.GetNamedBufferParameteriv(GLuint(words[0]), GL_BUFFER_SIZE, &bytes);
    } else {
      gl.GetBufferParameteriv(GLenum(words[0]), GL_BUFFER_SIZE, &bytes);
    }
    mapping.bytes = std::size_t(std::max(bytes, 0));
  }
  mapping.written_explicitly = by_range && (access & GL_MAP_FLUSH_EXPLICIT_BIT) != 0;
  if (by_range && (access & GL_MAP_PERSISTENT_BIT) != 0 && mapping.bytes != 0)
    mapping.seen.assign(mapping.first, mapping.first + mapping.bytes);
  mappings_.push_back(std::move(mapping));
}

}  // namespace understudy::spu
