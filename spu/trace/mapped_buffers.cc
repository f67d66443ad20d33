// SPDX-License-Identifier: Apache-2.0
#include "spu/trace/mapped_buffers.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>

#include "spu/stream/answers.h"
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

bool flushes(CallId call) {
  return call == CallId::FlushMappedBufferRange || call == CallId::FlushMappedNamedBufferRange ||
         call == CallId::FlushMappedNamedBufferRangeEXT;
}

/// Calls that may make OpenGL read a buffer while it stays mapped.
bool may_read_buffers(CallId call) {
  const std::string_view name = call_name(call);
  return name.starts_with("glDraw") || name.starts_with("glMultiDraw") || name.starts_with("glDispatch") ||
         name.starts_with("glCopy") || name.starts_with("glTex") || name.starts_with("glMemoryBarrier") ||
         name.starts_with("glFenceSync") || name == "glFlush" || name == "glFinish";
}

void* mapped_pointer(const DispatchTable& gl, CallId call, std::uint64_t target_or_name) {
  void* pointer = nullptr;
  if (std::string_view(call_name(call)).find("Named") != std::string_view::npos) {
    gl.GetNamedBufferPointerv(GLuint(target_or_name), GL_BUFFER_MAP_POINTER, &pointer);
  } else {
    gl.GetBufferPointerv(GLenum(target_or_name), GL_BUFFER_MAP_POINTER, &pointer);
  }
  return pointer;
}

}  // namespace

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
  if (unmaps_buffer(call) || flushes(call)) {
    const void* pointer = mapped_pointer(gl, call, words[0]);
    const auto found = std::find_if(mappings_.begin(), mappings_.end(),
                                    [&](const Mapping& mapping) { return mapping.first == pointer; });
    if (found == mappings_.end()) return;
    if (flushes(call)) {
      const auto offset = std::size_t(words[1]);
      const auto bytes = std::size_t(words[2]);
      if (offset <= found->bytes && bytes <= found->bytes - offset)
        append_write(found->first, offset, bytes, to);
      return;
    }
    if (!found->seen.empty()) {
      write_changes(*found, to);
    } else if (!found->written_explicitly) {
      append_write(found->first, 0, found->bytes, to);
    }
    mappings_.erase(found);
    return;
  }
  if (!may_read_buffers(call)) return;
  for (Mapping& mapping : mappings_) {
    if (!mapping.seen.empty()) write_changes(mapping, to);
  }
}

void MappedBuffers::after(const DispatchTable& gl, CallId call, const std::uint64_t* words,
                          std::uint64_t result) {
  if (!maps_a_buffer(call) || result == 0) return;
  const CallShape& shape = call_shape(call);
  const std::uint8_t access_at = argument_named(shape, "access");
  const std::uint8_t length_at = argument_named(shape, "length");
  const bool by_range = length_at != no_argument;
  const auto access = access_at == no_argument ? GLbitfield(0) : GLbitfield(words[access_at]);
  const bool writes = by_range ? (access & GL_MAP_WRITE_BIT) != 0 : access != GL_READ_ONLY;
  if (!writes) return;
  Mapping mapping;
  mapping.first = reinterpret_cast<std::byte*>(static_cast<std::uintptr_t>(result));
  if (by_range) {
    mapping.bytes = std::size_t(words[length_at]);
  } else {
    GLint bytes = 0;
    if (std::string_view(call_name(call)).find("Named") != std::string_view::npos) {
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
