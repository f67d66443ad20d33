// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/serve.h"

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

#include "apps/understudy/cli/balance_option.h"
#include "apps/understudy/cli/node_options.h"
#include "apps/understudy/cli/partition_option.h"
#include "apps/understudy/cli/sort_option.h"
#include "apps/understudy/gl_server/gl_server.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/launch/backend_option.h"
#include "apps/understudy/launch/listener.h"
#include "apps/understudy/launch/node_group.h"
#include "apps/understudy/launch/run_folder.h"
#include "apps/understudy/processes/environment.h"
#include "apps/understudy/processes/signal_inbox.h"
#include "compositor/logging/log.h"
#include "compositor/service/limits.h"
#include "compositor/transport/runtime_folder.h"
#include "compositor/transport/tcp/secret.h"
#include "spu/options.h"

namespace understudy::launcher {
namespace {

struct ServeArguments {
  std::optional<int> nodes;
  std::filesystem::path hostfile;
  NodeChoices choices;
  std::string socket;       ///< empty: in `folder`
  std::string folder;       ///< empty: a new private folder
  pid_t while_process = 0;  ///< process whose end ends this one; 0: run until a signal
  std::string listen;       ///< host:port for clients on other machines; empty: none
  std::filesystem::path secret_file;
  std::filesystem::path key_file;
  std::filesystem::path clients;
  bool server = false;
  bool plain = false;
  std::string tiles = "off";
  std::string server_opengl = "auto";
  std::string sandbox = "auto";
};

bool is_over(const ServeArguments& arguments) {
  return arguments.while_process > 0 && kill(arguments.while_process, 0) != 0 && errno == ESRCH;
}

/// Processes that serve clients on other machines.
struct Frontends {
  std::unique_ptr<ChildProcess> server;
  OpenListener listener;
};

/// Starts a GL server with the options of this environment and the nodes' socket.
std::unique_ptr<ChildProcess> start_gl_server_of_nodes(const Installation& installation,
                                                       const NodeGroupPlan& nodes,
                                                       const std::filesystem::path& socket,
                                                       const ServeArguments& arguments) {
  Environment environment = current_environment();
  environment.erase("UNDERSTUDY_REMOTE");
  environment.erase("UNDERSTUDY_RUN_DIR");
  environment["UNDERSTUDY_NODES"] = std::to_string(nodes.placement.ranks);
  environment["UNDERSTUDY_CONNECT"] = nodes.socket.string();
  environment["UNDERSTUDY_TILES"] = arguments.tiles;
  environment["UNDERSTUDY_SERVER_OPENGL"] = arguments.server_opengl;
  environment["UNDERSTUDY_SANDBOX"] = arguments.sandbox;
  return start_gl_server(installation, socket, environment);
}

Frontends open_frontends(const Installation& installation, const ServeArguments& arguments,
                         const NodeGroupPlan& nodes) {
  Frontends frontends;
  if (arguments.listen.empty()) return frontends;
  const auto address = compositor::tcp_address_of(arguments.listen);
  if (!address)
    throw std::runtime_error(
        fmt::format("--listen {}: not a HOST:PORT; give :7070 for this machine only, or 0.0.0.0:7070 for all "
                    "of its networks",
                    arguments.listen));
  bool made = false;
  if (!arguments.secret_file.empty()) compositor::read_or_make_secret(arguments.secret_file, made);
  if (made)
    fmt::print("understudy: created the secret {0}; copy it to the machines of the viewers: scp {0} HOST:\n",
               std::filesystem::absolute(arguments.secret_file).string());
  ListenerPlan plan{.address = *address,
                    .secret_file = arguments.secret_file,
                    .key_file = arguments.key_file,
                    .clients = arguments.clients,
                    .nodes = nodes.socket,
                    .server = {},
                    .folder = nodes.folder,
                    .plain = arguments.plain};
  if (arguments.server) {
    plan.server = nodes.folder / "gl_server.sock";
    frontends.server = start_gl_server_of_nodes(installation, nodes, plan.server, arguments);
  }
  frontends.listener = start_listener(installation, plan);
  return frontends;
}

/// Logs frontends that have ended, and continues without them: clients on this machine are still served.
void look_after(Frontends& frontends) {
  const auto ended = [](std::unique_ptr<ChildProcess>& process, const char* what) {
    if (!process) return;
    const std::optional<Ending> ending = process->poll_ending();
    if (!ending) return;
    logging::log(logging::Level::error, "{} {}; start understudy serve again", what, ending->text());
    process.reset();
  };
  ended(frontends.server, "the GL server, which draws for viewers on other machines,");
  ended(frontends.listener.process, "the listener, which accepts clients from other machines,");
}

/// Serves until a signal requests the end. On return, the nodes and the socket are gone.
int serve(const ServeArguments& arguments) {
  const Installation installation = this_installation();
  const Placement placement = placement_of({arguments.nodes, arguments.hostfile}, current_environment());
  if (placement.ranks == 0)
    throw std::runtime_error(
        "the number of nodes is missing; give -n N, or --hostfile FILE with the hosts to run them on");
  SignalInbox inbox({SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGCHLD});
  const RunFolder folder = arguments.folder.empty() ? RunFolder() : RunFolder(arguments.folder);
  if (const std::string obstacle = obstacle_to_nodes(installation); !obstacle.empty()) {
    logging::log(logging::Level::error, "{}", obstacle);
    return 1;
  }
  const std::filesystem::path socket = arguments.socket.empty() || !arguments.folder.empty()
                                           ? folder.path() / "nodes.sock"
                                           : std::filesystem::absolute(arguments.socket);
  NodeChoices choices = arguments.choices;
  for (std::string& data : choices.data) data = std::filesystem::absolute(data);
  const NodeGroupPlan plan{placement, socket, folder.path(), choices};
  NodeGroup nodes(installation, plan);
  Frontends frontends = open_frontends(installation, arguments, plan);
  bool announced = false;
  while (!is_over(arguments)) {
    while (const std::optional<ReceivedSignal> received = inbox.next()) {
      if (received->number != SIGCHLD) return 0;
      nodes.look_after_children();
      look_after(frontends);
    }
    nodes.wait_and_serve(inbox.descriptor());
    if (announced || !nodes.ready()) continue;
    announced = true;
    fmt::print("understudy: {0} {1} at {2}; use {3} with: understudy run --connect {2} -- viewer args…\n",
               nodes.ranks(), nodes.ranks() == 1 ? "node" : "nodes", socket.string(),
               nodes.ranks() == 1 ? "it" : "them");
    if (frontends.listener.process)
      fmt::print(
          "understudy: also at {0}; use them with: understudy run {1}--connect {0} {2} -- viewer args…\n",
          frontends.listener.address.text(), frontends.server ? "[--remote] " : "",
          arguments.secret_file.empty() ? "--key FILE --server-key FILE.pub" : "--secret-file FILE");
    std::fflush(stdout);
  }
  return 0;
}

void add_group_options(CLI::App& subcommand, ServeArguments& arguments) {
  subcommand
      .add_option("-n,--nodes", arguments.nodes,
                  "number of MPI ranks, on this machine or on the hosts of --hostfile; default: the slots of "
                  "the hostfile, or the tasks of the Slurm allocation")
      ->check(CLI::Range(1, spu::max_nodes));
  add_hostfile_option(subcommand, arguments.hostfile);
  add_backend_option(subcommand, arguments.choices.backend);
  add_gpu_memory_option(subcommand, arguments.choices.gpu_memory);
  add_sort_option(subcommand, arguments.choices.sort);
  add_partition_option(subcommand, arguments.choices.partition);
  add_balance_option(subcommand, arguments.choices.balance);
  subcommand
      .add_option("--socket", arguments.socket,
                  "path of the Unix socket that viewers connect to; without XDG_RUNTIME_DIR, the default is in "
                  "a private folder and is printed")
      ->capture_default_str();
  subcommand
      .add_option("--folder", arguments.folder,
                  "put the socket into DIR, which must be empty and have mode 0700, and remove DIR at the end")
      ->type_name("DIR")
      ->check(CLI::ExistingDirectory);
  subcommand
      .add_option("--data", arguments.choices.data,
                  "folders that clients may load volume files from (understudy render, view); default: none, "
                  "only volumes that clients send are rendered")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
  subcommand
      .add_option("--image-time", arguments.choices.image_ms,
                  "time limit of one image, in milliseconds; 0: as long as its client waits for it")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

/// Adds the options for clients on other machines. Returns --listen.
CLI::Option* add_listener_options(CLI::App& subcommand, ServeArguments& arguments) {
  subcommand
      .add_option("--secret-file", arguments.secret_file,
                  "with --listen: file of the secret that clients must have; created if it does not exist")
      ->type_name("FILE");
  CLI::Option* listen = subcommand
                            .add_option("--listen", arguments.listen,
                                        "accept clients over TCP at HOST:PORT; without HOST on this machine "
                                        "only, with 0.0.0.0 on all of its networks; port 0 takes any free port")
                            ->type_name("[HOST]:PORT");
  CLI::Option* key = subcommand
                         .add_option("--key", arguments.key_file,
                                     "with --listen: the key of this server (understudy key FILE), in addition "
                                     "to a secret or instead of one")
                         ->type_name("FILE")
                         ->needs(listen);
  CLI::Option* clients = subcommand
                             .add_option("--clients", arguments.clients,
                                         "with --key: file of the public keys of the clients that are "
                                         "accepted, one line of a FILE.pub for each")
                             ->type_name("FILE")
                             ->needs(key);
  key->needs(clients);
  return listen;
}

}  // namespace

void add_serve(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<ServeArguments>();
  arguments->choices.image_ms = int(compositor::limits::image_time.count());
  // A predictable name is safe only in a folder that others cannot write to.
  if (const auto runtime = compositor::private_runtime_folder())
    arguments->socket = *runtime / "understudy-nodes.sock";
  CLI::App* subcommand = app.add_subcommand("serve", "keeps render nodes running, for viewers to connect to");
  add_group_options(*subcommand, *arguments);
  add_exchange_options(*subcommand, arguments->choices);
  add_tiles_option(*subcommand, arguments->tiles);
  CLI::Option* listen = add_listener_options(*subcommand, *arguments);
  subcommand
      ->add_flag("--gl-server", arguments->server,
                 "also start a GL server, which executes the OpenGL calls of viewers without OpenGL "
                 "(understudy run --remote --connect HOST:PORT)")
      ->needs(listen);
  subcommand
      ->add_flag("--plain", arguments->plain,
                 "allow unencrypted connections of clients with --plain within this machine (for example "
                 "through ssh); all others are encrypted")
      ->needs(listen);
  add_gl_server_option(*subcommand, arguments->server_opengl);
  add_sandbox_option(*subcommand, arguments->sandbox);
  subcommand->add_option("--while", arguments->while_process, "end when the process PID ends")
      ->type_name("PID")
      ->check(CLI::PositiveNumber);
  subcommand->callback([arguments, &chosen] {
    if (!arguments->listen.empty() && arguments->secret_file.empty() && arguments->key_file.empty())
      throw CLI::RequiresError("--listen", "--secret-file or --key");
    chosen = [arguments] { return serve(*arguments); };
  });
}

}  // namespace understudy::launcher
