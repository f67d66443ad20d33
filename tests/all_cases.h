// SPDX-License-Identifier: Apache-2.0
// How much of a long list of cases a test goes through.
#pragma once

#include <cstdlib>
#include <vector>

namespace understudy {

/// All of it: `./run test --full` asks for that. Otherwise a part in which every kind of case occurs.
inline bool takes_all_cases() {
  return std::getenv("UNDERSTUDY_ALL_CASES") != nullptr;
}

/// Numbers of ranks up to 16: powers of two, odd ones and primes among them.
inline std::vector<int> numbers_of_ranks() {
  if (takes_all_cases()) return {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  return {1, 2, 3, 4, 5, 7, 12, 16};
}

}  // namespace understudy
