// SPDX-License-Identifier: Apache-2.0
// understudy: runs viewers with render nodes, and the related tools.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "apps/understudy/cli/compare.h"
#include "apps/understudy/cli/completion.h"
#include "apps/understudy/cli/configured_words.h"
#include "apps/understudy/cli/convert.h"
#include "apps/understudy/cli/ctl.h"
#include "apps/understudy/cli/doctor.h"
#include "apps/understudy/cli/help_layout.h"
#include "apps/understudy/cli/install_launcher.h"
#include "apps/understudy/cli/key.h"
#include "apps/understudy/cli/play.h"
#include "apps/understudy/cli/print.h"
#include "apps/understudy/cli/render.h"
#include "apps/understudy/cli/replay.h"
#include "apps/understudy/cli/run.h"
#include "apps/understudy/cli/serve.h"
#include "apps/understudy/cli/trim.h"
#include "apps/understudy/cli/units.h"
#include "apps/understudy/cli/version.h"
#include "apps/understudy/cli/view_program.h"
#include "apps/understudy/gl_server/gl_server.h"
#include "apps/understudy/launch/listener.h"
#include "apps/understudy/launch/relay.h"
#include "apps/understudy/option_table/usage_error.h"
#include "apps/understudy/study/study.h"
#include "compositor/logging/log.h"
#include "spu/former_names.h"

namespace launcher = understudy::launcher;

int main(int argc, char** argv) try {
  // Everything after the first "--" is the viewer's command and is not interpreted.
  const launcher::CommandLine line = launcher::split_at_double_dash(argc, argv);
  understudy::spu::rename_former_variables();

  CLI::App app{"Renders the volumes of unmodified OpenGL viewers by distributed ray casting.", "understudy"};
  app.formatter(std::make_shared<launcher::HelpLayout>());
  app.require_subcommand(1);
  app.set_help_flag("-h,--help", "print this help and exit");
  app.set_version_flag("--version", launcher::version_text, "print the version and exit");
  std::function<int()> chosen;
  launcher::add_run(app, line.viewer, chosen);
  launcher::add_config(app, chosen);
  launcher::add_install_launcher(app, line.viewer, chosen);
  launcher::add_replay(app, chosen);
  launcher::add_play(app, chosen);
  launcher::add_print(app, chosen);
  launcher::add_trim(app, chosen);
  launcher::add_serve(app, chosen);
  launcher::add_key(app, chosen);
  launcher::add_gl_server_command(app, chosen);
  launcher::add_listener(app, chosen);
  launcher::add_relay(app, chosen);
  launcher::add_render(app, chosen);
  launcher::add_view_program(app, line.own, chosen);
  launcher::add_study(app, chosen);
  launcher::add_convert(app, chosen);
  launcher::add_compare(app, chosen);
  launcher::add_ctl(app, chosen);
  launcher::add_doctor(app, chosen);
  launcher::add_units(app, chosen);
  launcher::add_completion(app, chosen);
  launcher::add_manual(app, chosen);
  launcher::group_options(app);
  launcher::CommandLine configured;
  try {
    configured = launcher::with_configuration(app, line);
  } catch (const std::runtime_error& error) {
    understudy::logging::log(understudy::logging::Level::error, "{}", error.what());
    return launcher::usage_error;
  }
  try {
    // CLI11 takes the arguments in reverse order, without the program's name.
    app.parse(std::vector<std::string>(configured.own.rbegin(), configured.own.rend() - 1));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "%s\n",
                 launcher::usage_error_text(app, std::span(configured.own).subspan(1), error).c_str());
    return launcher::usage_error;
  }
  return chosen();
} catch (const std::exception& error) {
  understudy::logging::log(understudy::logging::Level::error, "{}", error.what());
  return 1;
}
