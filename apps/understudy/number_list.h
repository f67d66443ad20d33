// Several numbers in one argument: "30,20,4", "512x512".
#pragma once

#include <string>
#include <vector>

namespace understudy::launcher {

/// `count` numbers with `separator` between them. Throws std::invalid_argument, with the example.
std::vector<double> numbers(const std::string& text, char separator, std::size_t count, const char* example);

}  // namespace understudy::launcher
