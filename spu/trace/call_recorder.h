// SPDX-License-Identifier: Apache-2.0
// One context's calls as the records of a stream that somebody else plays (StreamOrigin::elsewhere): each with
// what it reads, what it answered, and what the application wrote into mapped buffers before it counts.
#pragma once

#include <cstdint>

#include "spu/stream/encode.h"
#include "spu/trace/mapped_buffers.h"

namespace understudy::spu {

class CallRecorder {
 public:
  /// `driver` is asked what pointers mean.
  explicit CallRecorder(const DispatchTable& driver) : driver_(driver), encoder_(driver, [] {}) {}

  /// To be called before the call is made.
  void before(CallId call, const std::uint64_t* words, Records& to) {
    mapped_.before(driver_, call, words, to);
    encoder_.encode(call, words, to);
  }
  /// What the call has answered is for the stream, too.
  static bool answers(CallId call);
  static void append_answers(CallId call, const std::uint64_t* words, std::uint64_t result, Records& to);
  /// To be called after it.
  void made(CallId call, const std::uint64_t* words, std::uint64_t result) {
    mapped_.after(driver_, call, words, result);
  }

  bool inside_begin() const { return encoder_.inside_begin(); }

 private:
  const DispatchTable& driver_;
  Encoder encoder_;
  MappedBuffers mapped_;
};

}  // namespace understudy::spu
