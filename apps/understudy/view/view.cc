// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "apps/understudy/cli/loading_nodes.h"
#include "apps/understudy/cli/memory_option.h"
#include "apps/understudy/cli/output_file.h"
#include "apps/understudy/cli/view_program.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/view/view_state.h"
#include "apps/understudy/view/web_view.h"
#include "apps/understudy/view/window.h"
#include "compositor/service.h"

namespace understudy::launcher {
namespace {

constexpr int max_frames = 100000;
constexpr int last_port = 65535;

struct ViewArguments {
  SceneArguments scene;
  LoadingNodes nodes;
  std::optional<int> port;
  std::string host = WebAddress().host;
  std::string memory = "auto";
  WindowScript script;
};

int view(const ViewArguments& arguments) {
  FileScene scene = scene_of(arguments.scene);
  if (std::min(scene.image.width, scene.image.height) < least_view_side ||
      std::max(scene.image.width, scene.image.height) > most_view_side)
    throw std::invalid_argument(fmt::format("'{}' is not the size of a view; each side must be {} to {} pixels",
                                            arguments.scene.size, least_view_side, most_view_side));
  widen_ghost_layer(scene);
  const RankMemory memory = [&](int ranks) {
    return memory_for_volume(arguments.memory, ranks, ranks_are_here(arguments.nodes),
                             std::size_t(scene.image.width) * std::size_t(scene.image.height));
  };
  with_loading_nodes(arguments.nodes, [&](const ServiceMaker& make, const std::stop_token& stop) {
    if (arguments.port)
      show_on_web(scene, make, memory, stop, {arguments.host, *arguments.port});
    else
      show_in_window(scene, make, memory, stop, arguments.script);
  });
  return 0;
}

}  // namespace

void add_view(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = app.add_subcommand("view", view_description);
  add_scene_options(*command, arguments->scene);
  add_loading_nodes(*command, arguments->nodes);
  add_memory_option(*command, arguments->memory,
                    "memory limit of each rank; as many time steps of a series stay loaded as fit");
  CLI::Option* web =
      command
          ->add_option("--web", arguments->port,
                       "show the volume in browsers, under the link that is printed; port 0 takes any free one")
          ->check(CLI::Range(0, last_port))
          ->type_name("PORT");
  command
      ->add_option("--bind", arguments->host,
                   "address to listen on, by default on this machine only; connections are not encrypted, and "
                   "browsers elsewhere need `ssh -L` (docs/view.md)")
      ->type_name("HOST")
      ->needs(web)
      ->capture_default_str();
  CLI::Option* frames =
      command->add_option("--frames", arguments->script.frames, "close the window after this many frames")
          ->check(CLI::Range(1, max_frames))
          ->excludes(web);
  command
      ->add_option("--orbit", arguments->script.orbit, "degrees of azimuth to turn from one frame to the next")
      ->needs(frames);
  command
      ->add_flag(
          "--play", arguments->script.plays,
          "play the time steps of a series from the start; with --frames, each frame shows the next time step")
      ->excludes(web);
  command->add_option("--save", arguments->script.save, "PNG file for the last frame")
      ->type_name("P.png")
      ->needs(frames)
      ->check(can_be_written(".png"));
  command->callback([arguments, &chosen] { chosen = [arguments] { return view(*arguments); }; });
}

}  // namespace understudy::launcher
