// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/key.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "compositor/transport/tcp/key_file.h"

namespace understudy::launcher {

void add_key(CLI::App& app, std::function<int()>& chosen) {
  const auto file = std::make_shared<std::filesystem::path>();
  CLI::App* subcommand = app.add_subcommand("key",
                                            "creates a key pair for serve --key or for --connect: FILE, which "
                                            "only its owner may read, and FILE.pub for the other end");
  subcommand->add_option("file", *file, "file to write; it must not exist yet")->required()->type_name("FILE");
  subcommand->callback([file, &chosen] {
    chosen = [file] {
      const compositor::KeyPair key = compositor::make_key_file(*file);
      fmt::print("{}\n", compositor::line_of(key.public_key()));
      return 0;
    };
  });
}

}  // namespace understudy::launcher
