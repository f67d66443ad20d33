// SPDX-License-Identifier: Apache-2.0
// Amounts of memory on command lines: bytes, a whole number with K, M, G or T, or "auto".
#pragma once

#include <cstdint>
#include <string>

namespace understudy::launcher {

/// Converts 512M to 536870912 and leaves auto unchanged. Returns what is wrong, or an empty
/// string, as for CLI::Validator.
std::string to_byte_size(std::string& text);

/// Returns the number in a result of to_byte_size(); 0 for auto.
std::uint64_t byte_size(const std::string& text);

}  // namespace understudy::launcher
