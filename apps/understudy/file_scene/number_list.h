// SPDX-License-Identifier: Apache-2.0
// Parses several numbers in one argument: "30,20,4", "512x512".
#pragma once

#include <string>
#include <vector>

namespace understudy::launcher {

/// Parses `count` numbers, and up to `more` further ones, with `separator` between them. Throws
/// std::invalid_argument, which includes the example.
std::vector<double> numbers(const std::string& text, char separator, std::size_t count, const char* example,
                            std::size_t more = 0);

}  // namespace understudy::launcher
