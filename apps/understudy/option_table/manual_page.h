// SPDX-License-Identifier: Apache-2.0
// The manual page of a program with subcommands, in the language of man(7).
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
  /// Programs that belong to it, each with what it is.
  std::vector<std::pair<std::string, std::string>> others;
};

std::string text_of(const ManualPage& page);

}  // namespace understudy::launcher
