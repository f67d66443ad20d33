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
  CLI::App* subcommand =
      app.add_subcommand("completion", "what a shell reads to complete this program's command line");
  subcommand->add_option("shell", *shell, "bash, zsh or fish")
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
  CLI::App* subcommand = app.add_subcommand("manual", "the manual page, in the language of man(7)");
  subcommand->group("");
  subcommand->callback([&app, &chosen] {
    chosen = [&app] {
      const std::vector<SubcommandRow> subcommands = option_table(app);
      std::string summary = app.get_description();
      if (summary.ends_with('.')) summary.pop_back();
      summary.front() = char(std::tolower(static_cast<unsigned char>(summary.front())));
      fmt::print("{}",
                 text_of({app.get_name(),
                          version_number(),
                          summary,
                          subcommands,
                          {{"understudy-node", "a render node; `understudy` starts it by mpirun"},
                           {"understudy-view", "what `understudy view` starts, and its options"},
                           {"understudy-viewer", "a small volume viewer to try `understudy run` with"}}}));
      return 0;
    };
  });
}

}  // namespace understudy::launcher
