// SPDX-License-Identifier: Apache-2.0
// What a command line says of a file of raw scalars.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "volume/file/volume_file.h"

namespace understudy::launcher {

struct RawHints {
  std::vector<int> size;
  std::string type;
  bool big_endian = false;
};

void add_raw_hints(CLI::App& subcommand, RawHints& hints);

/// Throws std::invalid_argument for a type that there is not.
volume::FileHints file_hints(const RawHints& hints);

}  // namespace understudy::launcher
