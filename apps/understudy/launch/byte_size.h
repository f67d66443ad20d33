// SPDX-License-Identifier: Apache-2.0
// Amounts of memory on command lines: bytes, a whole number and K, M, G or T, or "auto".
#pragma once

#include <cstdint>
#include <string>

namespace understudy::launcher {

/// 512M becomes 536870912, auto stays; otherwise says what is wrong. As CLI::Validator takes it.
std::string to_byte_size(std::string& text);

/// Of what to_byte_size() has left; 0: auto.
std::uint64_t byte_size(const std::string& text);

}  // namespace understudy::launcher
