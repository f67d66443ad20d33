// SPDX-License-Identifier: Apache-2.0
// What an application writes into mapped buffers: no call tells of it, so it is looked for when it begins to
// count.
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
  /// Before a call: what the application wrote so far goes to `to` where the call makes it count -- unmapping
  /// and flushing, and for persistent mappings everything that may read a buffer.
  void before(const DispatchTable& gl, CallId call, const std::uint64_t* words, Records& to);
  /// After a call that maps a buffer.
  void after(const DispatchTable& gl, CallId call, const std::uint64_t* words, std::uint64_t result);

 private:
  struct Mapping {
    std::byte* first = nullptr;
    std::size_t bytes = 0;
    bool written_explicitly = false;  ///< GL_MAP_FLUSH_EXPLICIT_BIT
    std::vector<std::byte> seen;      ///< of persistent mappings: what the stream knows of the contents
  };

  void write_changes(Mapping& mapping, Records& to);

  std::vector<Mapping> mappings_;
};

}  // namespace understudy::spu
