// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/replay.h"

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/understudy/cli/balance_option.h"
#include "apps/understudy/cli/node_options.h"
#include "apps/understudy/cli/partition_option.h"
#include "apps/understudy/cli/play.h"
#include "apps/understudy/cli/run.h"
#include "apps/understudy/cli/sort_option.h"
#include "apps/understudy/launch/backend_option.h"
#include "apps/understudy/processes/installation.h"
#include "apps/understudy/progress/progress_option.h"
#include "spu/registry/assemble.h"

namespace understudy::launcher {
namespace {

struct ReplayArguments {
  std::filesystem::path trace;
  std::string frames;
  std::filesystem::path save_frames;
  bool native = false;
  std::string chain;
  ProgressOptions progress;
};

/// The player is a separate process, like a viewer: the nodes are supervised while it plays, and its figures
/// survive if a driver crashes it.
int replay(const ReplayArguments& replay, RunArguments arguments) {
  arguments.injection.reset();
  if (replay.native) arguments.settings["UNDERSTUDY_CHAIN"] = "driver";
  if (!replay.chain.empty())
    arguments.settings["UNDERSTUDY_CHAIN"] = spu::resolved_chain(replay.chain, std::filesystem::current_path());
  std::vector<std::string> command = {this_installation().programs / "understudy", "play", replay.trace};
  if (!replay.frames.empty()) command.insert(command.end(), {"--frames", replay.frames});
  if (!replay.save_frames.empty()) command.insert(command.end(), {"--save-frames", replay.save_frames});
  if (replay.progress.lines) command.emplace_back("--progress");
  if (replay.progress.quiet) {
    command.emplace_back("--quiet");
    say_less(arguments);
  }
  return run(arguments, command);
}

}  // namespace

void add_replay(CLI::App& app, std::function<int()>& chosen) {
  // These have a different meaning for a replay, or none.
  constexpr std::array<std::string_view, 4> without = {"--save-frames", "--chain", "--sandbox", "--control"};
  const auto own = std::make_shared<ReplayArguments>();
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* subcommand =
      app.add_subcommand("replay", "replays a trace of `understudy run --trace`, without viewer or display");
  subcommand->add_option("trace", own->trace, "trace file")->required()->check(CLI::ExistingFile);
  subcommand
      ->add_option("--frames", own->frames,
                   "save and count only frames A to B, counted from 1, and stop after frame B")
      ->type_name("A-B");
  subcommand
      ->add_option("--save-frames", own->save_frames,
                   "save the frames that the viewer showed (frame_0001.png, …) and the images that it read "
                   "back (read_0001.png, …) in DIR, with 8 bits per channel; UNDERSTUDY_SAVE_FRAMES saves the "
                   "nodes' float images, as for `run`")
      ->type_name("DIR");
  CLI::Option* native = subcommand->add_flag(
      "--native", own->native,
      "replay on the OpenGL driver alone: the frames are those that the viewer drew itself");
  subcommand
      ->add_option("--chain", own->chain,
                   "stream processing units to replay on, instead of the default ones [UNDERSTUDY_CHAIN]")
      ->type_name("UNITS")
      ->excludes(native);
  add_progress_options(*subcommand, own->progress);
  add_options_of_the_table(*subcommand, arguments, without);
  add_backend_option(*subcommand, arguments->backend);
  add_gpu_memory_option(*subcommand, arguments->gpu_memory);
  add_sort_option(*subcommand, arguments->sort);
  add_partition_option(*subcommand, arguments->partition);
  add_balance_option(*subcommand, arguments->balance);
  add_hostfile_option(*subcommand, arguments->hostfile);
  add_connection_options(*subcommand, arguments->connection);
  subcommand->callback([own, arguments, &chosen] {
    if (!own->frames.empty()) parse_frame_range(own->frames);
    chosen = [own, arguments] { return replay(*own, *arguments); };
  });
}

}  // namespace understudy::launcher
