// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/completion.h"

#include <fmt/format.h>

#include <cctype>
#include <memory>
#include <string>

#include "apps/understudy/option_table/completion.h"
#include "apps/understudy/option_table/manual_page.h"
#include "apps/understudy/option_table/option_table.h"
#include "apps/understudy/processes/build.h"

namespace understudy::launcher {

void add_completion(CLI::App& app, std::function<int()>& chosen) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* subcommand = app.add_subcommand("completion", "prints the command line completion for a shell");
  subcommand->add_option("shell", *shell, "shell to print the completion for")
      ->required()
      ->type_name("bash|zsh|fish")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}).description(""));
  subcommand->callback([&app, shell, &chosen] {
    chosen = [&app, shell] {
      fmt::print("{}", completion_text(*shell, app.get_name(), option_table(app)));
      return 0;
    };
  });
}

void add_manual(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* subcommand = app.add_subcommand("manual", "prints the manual page, in the format of man(7)");
  subcommand->group("");
  subcommand->callback([&app, &chosen] {
    chosen = [&app] {
      const std::vector<SubcommandRow> subcommands = option_table(app);
      std::string summary = app.get_description();
      if (summary.ends_with('.')) summary.pop_back();
      summary.front() = char(std::tolower(static_cast<unsigned char>(summary.front())));
      fmt::print(
          "{}",
          text_of({app.get_name(),
                   version_number(),
                   summary,
                   subcommands,
                   {{"understudy-node", "a render node, which `understudy` starts through mpirun"},
                    {"understudy-view", "the program that `understudy view` starts, with the same options"},
                    {"understudy-viewer", "a small volume viewer for trying out `understudy run`"}}}));
      return 0;
    };
  });
}

}  // namespace understudy::launcher
