// SPDX-License-Identifier: Apache-2.0
// Counts what this process sends through MPI, whichever library sends it. The functions of MPI's profiling
// interface count below the libraries that are compared.
#pragma once

#include <cstdint>

namespace understudy::bench {

struct Sent {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
};

/// Returns what this process has sent since the last call. A gather counts as the messages of its definition:
/// one to the root, or one to each other rank. Barriers do not count.
Sent take_sent();

}  // namespace understudy::bench
