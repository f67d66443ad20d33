// SPDX-License-Identifier: Apache-2.0
// What a command line that cannot be parsed gets to read: the word that is wrong, and the nearest right one.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>

namespace understudy::launcher {

/// Of `words`, the command line without the program's name, which `app` refused with `error`. Lines without a
/// line break at the end.
std::string usage_error_text(const CLI::App& app, std::span<const std::string> words,
                             const CLI::ParseError& error);

/// The word of `known` that was probably meant; empty: none is near.
std::string nearest_word(const std::string& word, std::span<const std::string> known);

}  // namespace understudy::launcher
