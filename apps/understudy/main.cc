// understudy: runs viewers with render nodes under them, and the tools around that.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>

#include "apps/understudy/compare.h"
#include "apps/understudy/doctor.h"
#include "apps/understudy/gl_server.h"
#include "apps/understudy/listener.h"
#include "apps/understudy/play.h"
#include "apps/understudy/print.h"
#include "apps/understudy/relay.h"
#include "apps/understudy/render.h"
#include "apps/understudy/replay.h"
#include "apps/understudy/run.h"
#include "apps/understudy/serve.h"
#include "apps/understudy/study/study.h"
#include "apps/understudy/trim.h"
#include "apps/understudy/units.h"
#include "apps/understudy/view_program.h"

namespace launcher = understudy::launcher;

int main(int argc, char** argv) try {
  // What follows the first "--" is the viewer's command and is not ours to interpret.
  const launcher::CommandLine line = launcher::split_at_double_dash(argc, argv);

  CLI::App app{"Lets render nodes play the part of a viewer's volume rendering."};
  app.require_subcommand(1);
  std::function<int()> chosen;
  launcher::add_run(app, line.viewer, chosen);
  launcher::add_replay(app, chosen);
  launcher::add_play(app, chosen);
  launcher::add_print(app, chosen);
  launcher::add_trim(app, chosen);
  launcher::add_serve(app, chosen);
  launcher::add_gl_server_command(app, chosen);
  launcher::add_listener(app, chosen);
  launcher::add_relay(app, chosen);
  launcher::add_render(app, chosen);
  launcher::add_view_program(app, argv, chosen);
  launcher::add_study(app, chosen);
  launcher::add_compare(app, chosen);
  launcher::add_doctor(app, chosen);
  launcher::add_units(app, chosen);
  try {
    app.parse(static_cast<int>(line.own.size()), line.own.data());
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : launcher::usage_error;
  }
  return chosen();
} catch (const std::exception& error) {
  std::fprintf(stderr, "understudy: %s\n", error.what());
  return 1;
}
