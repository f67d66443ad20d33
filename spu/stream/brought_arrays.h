// SPDX-License-Identifier: Apache-2.0
// Vertex arrays that are part of a stream: copies of the elements that the next draw reads. OpenGL's arrays
// point at them between the events `arrays` and `arrays_end` (client_arrays.h).
//
// In a stream from elsewhere, draws read no other memory. A pointer value from a stream can get into OpenGL in
// many ways (an offset whose buffer is deleted, a buffer name of 0 in calls that take arrays by name), so the
// arrays are checked before each draw, not only in the calls that set them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dispatch/call_shape.h"
#include "dispatch/table.h"
#include "spu/stream/client_arrays.h"
#include "spu/stream/record.h"

namespace understudy::spu {

class BroughtArrays {
 public:
  /// Executes an `arrays` event. With `copies` the elements outlive the record. Returns an error, or an empty
  /// string.
  std::string begin(const Record& record, const DispatchTable& gl, bool copies);
  /// Points the arrays where they had pointed before; to null unless `restores`.
  void end(const DispatchTable& gl, bool restores);

  /// Checks a call of a stream from elsewhere; returns an error, or an empty string. Queries the arrays before
  /// glBegin, since OpenGL answers no queries after it; if they cannot be queried, sets `left_out`: the draw
  /// must be skipped. May narrow the range that glDrawRangeElements specifies in `words`.
  std::string check(CallId call, std::uint64_t* words, bool inside_begin, const DispatchTable& gl,
                    bool& left_out);
  bool active() const { return active_; }

 private:
  struct Brought {
    ClientArray array;  ///< `pointer` is the sender's
    std::uint64_t pointer = 0;
    std::int64_t first = 0;
    std::int64_t elements = 0;
  };

  std::string take(std::span<const std::uint64_t> fields, const Record& record, const DispatchTable& gl,
                   bool copies);
  const std::byte* kept(std::span<const std::byte> data, bool copies);
  bool look(bool inside_begin, const DispatchTable& gl);
  void note_pointer(const ClientArray& array, std::uint64_t pointer);
  bool covers(const ClientArray& used, const ElementRange& range) const;
  std::string check_draw(CallId call, std::uint64_t* words, const DispatchTable& gl);

  bool active_ = false;
  std::vector<Brought> brought_;
  std::vector<std::vector<std::uint64_t>> copies_;  ///< not freed, so that their memory is reused
  std::size_t copies_used_ = 0;
  /// Enabled arrays without a buffer object, as queried; nothing if they may have changed since.
  std::optional<std::vector<ClientArray>> in_memory_;
};

}  // namespace understudy::spu
