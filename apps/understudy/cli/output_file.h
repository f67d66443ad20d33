// SPDX-License-Identifier: Apache-2.0
// Files that a command writes at its end: whether that is possible is found out before it begins.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace understudy::launcher {

/// For CLI::Option::check(): the file can be made or overwritten, and its name ends as its format does,
/// `ending`
/// (".png"); empty: any name. Nothing is changed.
CLI::Validator can_be_written(const std::string& ending = {});

}  // namespace understudy::launcher
