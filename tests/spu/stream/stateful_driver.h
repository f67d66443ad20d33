// SPDX-License-Identifier: Apache-2.0
// A driver for tests of the stream: it keeps the few things a stream depends on -- the pixel store and the
// bindings -- and notes every call with what its pointers point at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu::testing {

/// A call as OpenGL would have seen it. Of pointers to input the bytes, pixels as tight_image() lays them; of
/// offsets and outputs nothing.
struct SeenCall {
  CallId call;
  std::vector<std::uint64_t> values;
  std::vector<std::vector<std::byte>> read;
  bool operator==(const SeenCall&) const = default;
};

std::string text(const SeenCall& call);

/// One at a time on a thread.
class StatefulDriver {
 public:
  StatefulDriver();
  ~StatefulDriver();
  StatefulDriver(const StatefulDriver&) = delete;
  StatefulDriver& operator=(const StatefulDriver&) = delete;

  const DispatchTable& table() const { return table_; }
  void set(GLenum name, GLint value) { integers_[name] = value; }
  GLint get(GLenum name) const {
    const auto found = integers_.find(name);
    return found == integers_.end() ? 0 : found->second;
  }

  /// Without what asks and sets the pixel store.
  const std::vector<SeenCall>& calls() const { return calls_; }
  void forget() { calls_.clear(); }
  /// Reads nothing behind pointers; for streams that are not to be believed in all they say.
  bool counts_only = false;
  std::uint64_t counted = 0;

 private:
  struct Slots;

  DispatchTable table_{};
  std::map<GLenum, GLint> integers_;
  std::vector<SeenCall> calls_;
};

}  // namespace understudy::spu::testing
