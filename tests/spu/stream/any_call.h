// SPDX-License-Identifier: Apache-2.0
// Arguments for any command of the registry, with memory behind every pointer.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "dispatch/call_shape.h"

namespace understudy::spu::testing {

class AnyCall {
 public:
  /// Fills words with values that fit together: small counts, known formats and types.
  AnyCall(CallId call, std::mt19937& random);
  const std::uint64_t* words() const { return words_.data(); }

 private:
  std::array<std::uint64_t, max_parameters> words_{};
  std::vector<std::vector<std::byte>> memory_;
};

}  // namespace understudy::spu::testing
