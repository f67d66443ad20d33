// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>

#include "apps/understudy/cli/balance_option.h"
#include "apps/understudy/cli/node_options.h"
#include "apps/understudy/cli/output_file.h"
#include "apps/understudy/cli/partition_option.h"
#include "apps/understudy/cli/sort_option.h"
#include "apps/understudy/cli/trace_option.h"
#include "apps/understudy/launch/backend_option.h"
#include "apps/understudy/launch/say.h"
#include "compositor/logging/log.h"
#include "spu/former_names.h"
#include "spu/options.h"

namespace understudy::launcher {
namespace {

int run_viewer(RunArguments arguments, const std::vector<std::string>& command) {
  if (command.empty()) {
    say("the command of the viewer is missing; put it after --: understudy run [options] -- viewer args…");
    return usage_error;
  }
  if (!arguments.trace.empty()) prepare_trace(arguments);
  if (arguments.quiet) say_less(arguments);
  const int status = run(arguments, command);
  if (!arguments.trace.empty() && !arguments.quiet) say(trace_summary(arguments.trace));
  return status;
}

}  // namespace

void add_options_of_the_table(CLI::App& subcommand, const std::shared_ptr<RunArguments>& arguments,
                              std::span<const std::string_view> without) {
  for (const spu::OptionText& option : spu::option_table()) {
    const std::string flag = option.flag;
    const std::string variable = option.environment;
    const std::string value = option.value;
    if (flag.empty() || std::find(without.begin(), without.end(), flag) != without.end()) continue;
    const auto take = [arguments, variable, flag, help = option.help](const std::string& text) {
      spu::Options scratch;
      if (!spu::set_option(scratch, variable, text)) {
        throw CLI::ValidationError(flag, fmt::format("'{}' is not a value this option takes: {}", text, help));
      }
      arguments->settings[variable] = text;
    };
    const std::string help = fmt::format("{} [{}]", option.help, variable);
    if (value.empty()) {
      subcommand.add_flag_callback(
          flag, [take] { take("1"); }, help);
    } else if (value.front() == '[') {
      subcommand
          .add_option_function<std::string>(
              flag, [take](const std::string& text) { take(text.empty() ? "1" : text); }, help)
          ->expected(0, 1)
          ->type_name(value);
    } else {
      CLI::Option* const taken =
          subcommand.add_option_function<std::string>(flag, take, help)->type_name(value);
      if (flag == "--report") taken->check(can_be_written());
    }
  }
}

void say_less(RunArguments& arguments) {
  arguments.quiet = true;
  arguments.settings["UNDERSTUDY_LOG"] = "warn";
}

CommandLine split_at_double_dash(int argc, char** argv) {
  CommandLine line;
  int position = 0;
  while (position < argc && std::strcmp(argv[position], "--") != 0) line.own.emplace_back(argv[position++]);
  line.own = spu::with_present_options(line.own);
  for (++position; position < argc; ++position) line.viewer.emplace_back(argv[position]);
  return line;
}

void add_run(CLI::App& app, const std::vector<std::string>& viewer, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* subcommand = app.add_subcommand(
      "run", "runs an OpenGL viewer and renders its volumes: understudy run [options] -- viewer args…");
  subcommand->footer(
      "An environment variable in brackets sets the same option; the command line takes precedence.");
  add_options_of_the_table(*subcommand, arguments);
  add_backend_option(*subcommand, arguments->backend);
  add_gpu_memory_option(*subcommand, arguments->gpu_memory);
  add_sort_option(*subcommand, arguments->sort);
  add_partition_option(*subcommand, arguments->partition);
  add_balance_option(*subcommand, arguments->balance);
  add_hostfile_option(*subcommand, arguments->hostfile);
  add_connection_options(*subcommand, arguments->connection);
  const std::map<std::string, InjectionMethod> injection_methods{{"audit", InjectionMethod::audit},
                                                                 {"preload", InjectionMethod::preload},
                                                                 {"folder", InjectionMethod::folder}};
  subcommand
      ->add_option("--injection", arguments->injection,
                   "method by which OpenGL calls are intercepted: audit (LD_AUDIT; default, intercepts all of "
                   "them), preload (LD_PRELOAD) or folder (LD_LIBRARY_PATH)")
      ->transform(CLI::CheckedTransformer(injection_methods, CLI::ignore_case).description(""))
      ->type_name("audit|preload|folder");
  subcommand
      ->add_option("--trace", arguments->trace,
                   "record every OpenGL call in FILE, for `understudy replay`; calls of further processes of "
                   "the viewer are recorded in FILE.PID")
      ->type_name("FILE")
      ->check(can_be_written());
  subcommand->add_flag("--remote", arguments->remote,
                       "run the viewer without OpenGL of its own: a GL server beside the nodes executes its "
                       "calls and sends images to its windows; with --connect HOST:PORT, the GL server of that "
                       "machine (understudy serve --gl-server)");
  subcommand->add_flag("--require", arguments->required,
                       "exit with status 3 if no frame was substituted, and with 4 if the GL server of "
                       "--remote was lost, unless the viewer itself failed");
  subcommand->add_flag("--quiet", arguments->quiet, "print only warnings and errors");
  subcommand->callback([arguments, &viewer, &chosen] {
    chosen = [arguments, &viewer] { return run_viewer(*arguments, viewer); };
  });
}

}  // namespace understudy::launcher
