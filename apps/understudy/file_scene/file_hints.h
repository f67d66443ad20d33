// SPDX-License-Identifier: Apache-2.0
// What a command line says of a file: of raw scalars what these do not say themselves, and which channel is
// meant.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "volume/file/volume_file.h"

namespace understudy::launcher {

struct FileHintOptions {
  std::vector<int> size;
  std::string type;
  bool big_endian = false;
  std::optional<int> channel;
};

void add_file_hints(CLI::App& subcommand, FileHintOptions& hints);

/// Throws std::invalid_argument for a type that there is not.
volume::FileHints file_hints(const FileHintOptions& hints);

}  // namespace understudy::launcher
