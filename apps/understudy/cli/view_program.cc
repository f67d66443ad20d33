// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/view_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "apps/understudy/processes/installation.h"

namespace understudy::launcher {

void add_view_program(CLI::App& app, const std::vector<std::string>& arguments, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand("view", view_description);
  command->prefix_command();
  command->set_help_flag();
  command->callback([&arguments, &chosen] {
    chosen = [&arguments]() -> int {
      const std::filesystem::path program = this_installation().programs / "understudy-view";
      std::vector<char*> words;
      for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
      words.push_back(nullptr);
      ::execv(program.c_str(), words.data());
      throw std::runtime_error(fmt::format("{}: {}; it is built and installed with this program",
                                           program.string(), std::strerror(errno)));
    };
  });
}

}  // namespace understudy::launcher
