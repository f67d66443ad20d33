// SPDX-License-Identifier: Apache-2.0
// A driver for tests of the stream: it keeps the state that a stream depends on, the pixel store and the
// bindings, and records every call together with the data that its pointers point to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu::testing {

/// A call as OpenGL sees it. Holds the bytes that input pointers point to, with pixels in tight_image() layout;
/// nothing for offsets and outputs.
struct SeenCall {
  CallId call;
  std::vector<std::uint64_t> values;
  std::vector<std::vector<std::byte>> read;
  bool operator==(const SeenCall&) const = default;
};

std::string text(const SeenCall& call);

/// At most one per thread at a time.
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

  /// Without the calls that query and set the pixel store.
  const std::vector<SeenCall>& calls() const { return calls_; }
  void forget() { calls_.clear(); }
  /// Does not read behind pointers; for streams that are not entirely trusted.
  bool counts_only = false;
  std::uint64_t counted = 0;

 private:
  struct Slots;

  DispatchTable table_{};
  std::map<GLenum, GLint> integers_;
  std::vector<SeenCall> calls_;
};

}  // namespace understudy::spu::testing
