// SPDX-License-Identifier: Apache-2.0
// Checks, before a command begins, that the files it writes at its end can be written.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace understudy::launcher {

/// For CLI::Option::check(): checks that the file can be created or overwritten, and that its name ends with
/// `ending` (".png"), or has any name if `ending` is empty. Changes nothing.
CLI::Validator can_be_written(const std::string& ending = {});

}  // namespace understudy::launcher
