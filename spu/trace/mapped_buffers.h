// SPDX-License-Identifier: Apache-2.0
// Detects what an application writes into mapped buffers. No call reports it, so buffers are compared when
// their contents take effect.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/table.h"
#include "spu/stream/record.h"

namespace understudy::spu {

class MappedBuffers {
 public:
  /// Before a call: appends the application's writes so far to `to` if the call makes them take effect --
  /// unmapping and flushing, and for persistent mappings every call that may read a buffer.
  void before(const DispatchTable& gl, CallId call, const std::uint64_t* words, Records& to);
  /// After a call: tracks a mapping that it created.
  void after(const DispatchTable& gl, CallId call, const std::uint64_t* words, std::uint64_t result);

 private:
  struct Mapping {
    std::byte* first = nullptr;
    std::size_t bytes = 0;
    bool written_explicitly = false;  ///< GL_MAP_FLUSH_EXPLICIT_BIT
    std::vector<std::byte> seen;      ///< contents of persistent mappings as recorded so far
  };

  void write_changes(Mapping& mapping, Records& to);

  std::vector<Mapping> mappings_;
};

}  // namespace understudy::spu
