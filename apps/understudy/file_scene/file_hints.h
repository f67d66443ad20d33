// SPDX-License-Identifier: Apache-2.0
// Options that describe a file: what raw scalars do not specify themselves, and which channel to read.
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

/// Throws std::invalid_argument for an unknown type.
volume::FileHints file_hints(const FileHintOptions& hints);

}  // namespace understudy::launcher
