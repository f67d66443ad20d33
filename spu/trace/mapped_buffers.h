// SPDX-License-Identifier: Apache-2.0
// Detects what an application writes into mapped buffers. No call reports it, so buffers are compared when
// their contents take effect.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/table.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// Whose memory is mapped. The driver's may vanish by a call in another context.
enum class MappedMemory { of_driver, of_this_process };

class MappedBuffers {
 public:
  explicit MappedBuffers(MappedMemory memory) : memory_(memory) {}

  /// Before a call, which is not between glBegin and glEnd: appends the application's writes so far to `to` if
  /// the call makes them take effect -- unmapping and flushing, and for persistent mappings every call that may
  /// read a buffer. Forgets mappings that the call ends.
  void before(const DispatchTable& gl, CallId call, const std::uint64_t* words, Records& to);
  /// After a call: tracks a mapping that it created.
  void after(const DispatchTable& gl, CallId call, const std::uint64_t* words, std::uint64_t result);

  /// Appends the application's writes so far into persistent mappings.
  void append_persistent(const DispatchTable& gl, Records& to);
  /// OpenGL has changed a persistent mapping to `contents`: stores the bytes that differ from what was
  /// recorded, so that writes which the application is just making stay. Returns false if the mapping is not
  /// written to.
  bool refresh(GLuint buffer, std::span<const std::byte> contents);

 private:
  struct Mapping {
    GLuint buffer = 0;
    std::byte* first = nullptr;
    std::size_t bytes = 0;
    bool written_explicitly = false;  ///< GL_MAP_FLUSH_EXPLICIT_BIT
    std::vector<std::byte> seen;      ///< contents of persistent mappings as recorded so far
  };

  Mapping* find(GLuint buffer);
  void forget(GLuint buffer);
  bool is_mapped(const DispatchTable& gl, const Mapping& mapping) const;
  void flush(const DispatchTable& gl, const std::uint64_t* words, GLuint buffer, Records& to);
  void unmap(const DispatchTable& gl, GLuint buffer, Records& to);
  void write_changes(Mapping& mapping, Records& to);

  const MappedMemory memory_;
  std::vector<Mapping> mappings_;
};

}  // namespace understudy::spu
