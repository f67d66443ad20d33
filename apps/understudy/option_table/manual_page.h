// SPDX-License-Identifier: Apache-2.0
// Generates the manual page of a program with subcommands, in the format of man(7).
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "apps/understudy/option_table/option_table.h"

namespace understudy::launcher {

struct ManualPage {
  std::string program;
  std::string version;
  std::string summary;  ///< a line without a full stop
  std::span<const SubcommandRow> subcommands;
  /// Related programs, each with its description.
  std::vector<std::pair<std::string, std::string>> others;
};

std::string text_of(const ManualPage& page);

}  // namespace understudy::launcher
