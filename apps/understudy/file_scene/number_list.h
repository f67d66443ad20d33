// SPDX-License-Identifier: Apache-2.0
// Several numbers in one argument: "30,20,4", "512x512".
#pragma once

#include <string>
#include <vector>

namespace understudy::launcher {

/// `count` numbers, and up to `more` behind them, with `separator` in between. Throws std::invalid_argument,
/// with the example.
std::vector<double> numbers(const std::string& text, char separator, std::size_t count, const char* example,
                            std::size_t more = 0);

}  // namespace understudy::launcher
