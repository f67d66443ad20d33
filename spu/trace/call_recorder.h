// SPDX-License-Identifier: Apache-2.0
// Records one context's calls as a stream that another process plays (StreamOrigin::elsewhere): each call with
// the memory that it reads, its answer, and what the application has written into mapped buffers before the
// call takes effect.
#pragma once

#include <cstdint>

#include "spu/stream/encode.h"
#include "spu/trace/mapped_buffers.h"

namespace understudy::spu {

class CallRecorder {
 public:
  /// `driver` is queried for the meaning of pointers.
  explicit CallRecorder(const DispatchTable& driver) : driver_(driver), encoder_(driver, [] {}) {}

  /// Must be called before the call is made.
  void before(CallId call, const std::uint64_t* words, Records& to) {
    if (!inside_begin()) mapped_.before(driver_, call, words, to);
    encoder_.encode(call, words, to);
  }
  /// Whether the call's answer belongs in the stream.
  static bool answers(CallId call);
  static void append_answers(CallId call, const std::uint64_t* words, std::uint64_t result, Records& to);
  /// Must be called after the call was made.
  void made(CallId call, const std::uint64_t* words, std::uint64_t result) {
    mapped_.after(driver_, call, words, result);
  }

  bool inside_begin() const { return encoder_.inside_begin(); }

 private:
  const DispatchTable& driver_;
  Encoder encoder_;
  MappedBuffers mapped_{MappedMemory::of_driver};
};

}  // namespace understudy::spu
