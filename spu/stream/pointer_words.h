// SPDX-License-Identifier: Apache-2.0
// Converts an application's pointer to the word in a record, and back.
#pragma once

#include <cstddef>
#include <cstdint>

namespace understudy::spu {

inline const std::byte* address_in(std::uint64_t word) {
  return reinterpret_cast<const std::byte*>(static_cast<std::uintptr_t>(word));
}

inline std::uint64_t word_of(const void* pointer) {
  return reinterpret_cast<std::uintptr_t>(pointer);
}

}  // namespace understudy::spu
