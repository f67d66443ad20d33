// SPDX-License-Identifier: Apache-2.0
// Calls for buffers that are mapped into the application's memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

/// Whether the call refers to a buffer by its name instead of the target that it is bound to.
inline bool is_by_name(CallId call) {
  return std::string_view(call_name(call)).find("Named") != std::string_view::npos;
}

inline bool unmaps_buffer(CallId call) {
  return call == CallId::UnmapBuffer || call == CallId::UnmapBufferARB || call == CallId::UnmapNamedBuffer ||
         call == CallId::UnmapNamedBufferEXT;
}

inline bool flushes_mapping(CallId call) {
  return call == CallId::FlushMappedBufferRange || call == CallId::FlushMappedNamedBufferRange ||
         call == CallId::FlushMappedNamedBufferRangeEXT;
}

/// Whether the call gives a buffer new storage, which ends its mapping. Buffers that are mapped persistently
/// reject it.
inline bool replaces_storage(CallId call) {
  switch (call) {
    case CallId::BufferData:
    case CallId::BufferDataARB:
    case CallId::BufferStorage:
    case CallId::BufferStorageEXT:
    case CallId::BufferStorageExternalEXT:
    case CallId::BufferStorageMemEXT:
    case CallId::NamedBufferData:
    case CallId::NamedBufferDataEXT:
    case CallId::NamedBufferStorage:
    case CallId::NamedBufferStorageEXT:
    case CallId::NamedBufferStorageExternalEXT:
    case CallId::NamedBufferStorageMemEXT:
      return true;
    default:
      return false;
  }
}

inline bool deletes_buffers(CallId call) {
  return call == CallId::DeleteBuffers || call == CallId::DeleteBuffersARB;
}

/// The names in a call that deletes buffers.
inline std::span<const GLuint> deleted_buffers(const std::uint64_t* words) {
  const auto* names = reinterpret_cast<const GLuint*>(static_cast<std::uintptr_t>(words[1]));
  if (names == nullptr) return {};
  return {names, std::size_t(std::max(GLsizei(words[0]), 0))};
}

}  // namespace understudy::spu
