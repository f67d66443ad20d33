// SPDX-License-Identifier: Apache-2.0
// Messages for command lines that cannot be parsed: the wrong word, and the nearest right one.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>

namespace understudy::launcher {

/// Returns the message for `words`, the command line without the program's name, which `app` rejected with
/// `error`. No line break at the end.
std::string usage_error_text(const CLI::App& app, std::span<const std::string> words,
                             const CLI::ParseError& error);

/// Returns the word of `known` that was probably meant; empty: none is near.
std::string nearest_word(const std::string& word, std::span<const std::string> known);

}  // namespace understudy::launcher
