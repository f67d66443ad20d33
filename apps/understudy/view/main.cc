// SPDX-License-Identifier: Apache-2.0
// understudy-view: the program that `understudy view` executes, with the same arguments.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/understudy/cli/help_layout.h"
#include "apps/understudy/cli/run.h"
#include "apps/understudy/option_table/usage_error.h"
#include "apps/understudy/view/view.h"
#include "compositor/logging/log.h"

namespace launcher = understudy::launcher;

int main(int argc, char** argv) try {
  CLI::App app{"Shows volume files in a browser or a window.", "understudy"};
  app.formatter(std::make_shared<launcher::HelpLayout>());
  app.require_subcommand(1);
  app.set_help_flag("-h,--help", "print this help and exit");
  std::function<int()> chosen;
  launcher::add_view(app, chosen);
  launcher::group_options(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    const std::vector<std::string> words(argv + 1, argv + argc);
    std::fprintf(stderr, "%s\n", launcher::usage_error_text(app, words, error).c_str());
    return launcher::usage_error;
  }
  return chosen();
} catch (const std::exception& error) {
  understudy::logging::log(understudy::logging::Level::error, "{}", error.what());
  return 1;
}
