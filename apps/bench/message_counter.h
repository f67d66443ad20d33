// SPDX-License-Identifier: Apache-2.0
// What a process sends through MPI, whoever asks for it: counted in MPI's own profiling interface, below the
// libraries that are compared.
#pragma once

#include <cstdint>

namespace understudy::bench {

struct Sent {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
};

/// By this process since it was last asked. A gathering counts as the messages that its definition says: one to
/// the root, or one to each other rank. Barriers count for nothing.
Sent take_sent();

}  // namespace understudy::bench
