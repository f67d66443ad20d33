// SPDX-License-Identifier: Apache-2.0
// Vertex arrays that came with a stream: copies of the elements that the next draw reads, at which OpenGL's
// arrays point between the events `arrays` and `arrays_end` (client_arrays.h).
//
// In a stream from elsewhere no draw reads any other memory. A pointer that a stream named can get into OpenGL
// in many ways (an offset whose buffer is deleted, a buffer name of 0 in the calls that take arrays by name),
// so the arrays are looked at before a draw, and not only at the calls that set them.
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
  /// Does what an `arrays` event says. With `copies` the elements outlive the record. Answers what is wrong.
  std::string begin(const Record& record, const DispatchTable& gl, bool copies);
  /// The arrays point where they had pointed; nowhere unless `restores`.
  void end(const DispatchTable& gl, bool restores);

  /// What is wrong with a call of a stream from elsewhere, or nothing. Looks before glBegin, since OpenGL
  /// answers nothing behind it; a draw about which it answers nothing is to be left out. May narrow the range
  /// that glDrawRangeElements claims in `words`.
  std::string check(CallId call, std::uint64_t* words, bool inside_begin, const DispatchTable& gl,
                    bool& left_out);
  bool active() const { return active_; }

 private:
  struct Brought {
    ClientArray array;  ///< `pointer` as the sender had it
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
  std::vector<std::vector<std::uint64_t>> copies_;  ///< kept for their memory
  std::size_t copies_used_ = 0;
  /// Enabled arrays without a buffer object, as OpenGL told; nothing when they may be others by now.
  std::optional<std::vector<ClientArray>> in_memory_;
};

}  // namespace understudy::spu
