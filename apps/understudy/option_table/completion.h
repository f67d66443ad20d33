// SPDX-License-Identifier: Apache-2.0
// Command line completion for shells.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "apps/understudy/option_table/option_table.h"

namespace understudy::launcher {

/// Returns the completion script of `program` for `shell` (bash, zsh or fish). Throws
/// std::invalid_argument for any other shell.
std::string completion_text(std::string_view shell, std::string_view program,
                            std::span<const SubcommandRow> subcommands);

}  // namespace understudy::launcher
