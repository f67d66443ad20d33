// SPDX-License-Identifier: Apache-2.0
// Completion of the command line in a shell.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "apps/understudy/option_table/option_table.h"

namespace understudy::launcher {

/// What `shell` (bash, zsh or fish) reads to complete `program`. Throws std::invalid_argument for another.
std::string completion_text(std::string_view shell, std::string_view program,
                            std::span<const SubcommandRow> subcommands);

}  // namespace understudy::launcher
