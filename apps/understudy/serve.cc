#include "apps/understudy/serve.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/types.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "apps/understudy/backend_option.h"
#include "apps/understudy/balance_option.h"
#include "apps/understudy/environment.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/node_group.h"
#include "apps/understudy/node_options.h"
#include "apps/understudy/run_folder.h"
#include "apps/understudy/signal_inbox.h"
#include "spu/options.h"

namespace understudy::launcher {
namespace {

struct ServeArguments {
  std::optional<int> nodes;
  std::filesystem::path hostfile;
  NodeChoices choices;
  std::string socket;
  std::string folder;       ///< empty: one of its own
  pid_t while_process = 0;  ///< 0: until asked to end
};

bool is_over(const ServeArguments& arguments) {
  return arguments.while_process > 0 && kill(arguments.while_process, 0) != 0 && errno == ESRCH;
}

/// Returns when a signal asks for the end. The nodes and the socket are gone then.
int serve(const ServeArguments& arguments) {
  const Installation installation = this_installation();
  const Placement placement = placement_of({arguments.nodes, arguments.hostfile}, current_environment());
  if (placement.ranks == 0)
    throw std::runtime_error("how many nodes? Give -n N, or --hostfile FILE with the hosts that they run on");
  SignalInbox inbox({SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGCHLD});
  const RunFolder folder = arguments.folder.empty() ? RunFolder() : RunFolder(arguments.folder);
  if (const std::string obstacle = obstacle_to_nodes(installation); !obstacle.empty()) {
    fmt::print(stderr, "understudy: {}\n", obstacle);
    return 1;
  }
  const std::filesystem::path socket =
      arguments.folder.empty() ? std::filesystem::absolute(arguments.socket) : folder.path() / "nodes.sock";
  NodeGroup nodes(installation, {placement, socket, folder.path(), arguments.choices});
  bool announced = false;
  while (!is_over(arguments)) {
    while (const std::optional<ReceivedSignal> received = inbox.next()) {
      if (received->number != SIGCHLD) return 0;
      nodes.look_after_children();
    }
    nodes.wait_and_serve(inbox.descriptor());
    if (announced || !nodes.ready()) continue;
    announced = true;
    fmt::print("understudy: {} nodes at {}; use them with: understudy run --connect {} -- viewer args…\n",
               nodes.ranks(), socket.string(), socket.string());
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

void add_serve(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<ServeArguments>();
  arguments->socket = runtime_directory() / "understudy-nodes.sock";
  CLI::App* subcommand = app.add_subcommand("serve", "keeps render nodes running for viewers that come and go");
  subcommand
      ->add_option(
          "-n,--nodes", arguments->nodes,
          "MPI ranks, on this machine or on those of --hostfile; without: as many as that has slots, or "
          "a Slurm allocation tasks")
      ->check(CLI::Range(1, spu::max_nodes));
  add_hostfile_option(*subcommand, arguments->hostfile);
  add_backend_option(*subcommand, arguments->choices.backend);
  add_gpu_memory_option(*subcommand, arguments->choices.gpu_memory);
  add_balance_option(*subcommand, arguments->choices.balance);
  subcommand->add_option("--socket", arguments->socket, "where viewers find them")->capture_default_str();
  subcommand
      ->add_option("--folder", arguments->folder,
                   "take over DIR, with the socket in it, and remove it at the end")
      ->type_name("DIR")
      ->check(CLI::ExistingDirectory);
  add_exchange_options(*subcommand, arguments->choices);
  subcommand->add_option("--while", arguments->while_process, "end when the process PID has ended")
      ->type_name("PID")
      ->check(CLI::PositiveNumber);
  subcommand->callback([arguments, &chosen] { chosen = [arguments] { return serve(*arguments); }; });
}

}  // namespace understudy::launcher
