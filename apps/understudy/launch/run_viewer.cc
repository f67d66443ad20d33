// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/run_viewer.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "apps/understudy/gl_server/gl_server.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/launch/backend_option.h"
#include "apps/understudy/launch/connection_figures.h"
#include "apps/understudy/launch/exported_scenes.h"
#include "apps/understudy/launch/node_group.h"
#include "apps/understudy/launch/relay.h"
#include "apps/understudy/launch/run_figures.h"
#include "apps/understudy/launch/run_folder.h"
#include "apps/understudy/launch/say.h"
#include "apps/understudy/processes/child_process.h"
#include "apps/understudy/processes/environment.h"
#include "apps/understudy/processes/installation.h"
#include "apps/understudy/processes/origin.h"
#include "apps/understudy/processes/output_obstacle.h"
#include "apps/understudy/processes/signal_inbox.h"
#include "compositor/exchange/settings.h"
#include "compositor/logging/log.h"
#include "compositor/transport/tcp/address.h"
#include "spu/chain_text.h"
#include "spu/control/control_folder.h"
#include "spu/options.h"
#include "spu/registry/assemble.h"
#include "spu/report/keys.h"
#include "spu/report/report.h"

namespace understudy::launcher {
namespace {

constexpr int not_executable = 126;
constexpr int cannot_start_viewer = 127;
constexpr int server_patience_ms = 5000;
/// Chain of a viewer whose calls a GL server executes: nothing is recognised in the viewer's process. A chain
/// that runs in such a viewer ends in remote.
constexpr const char* remote_chain = "pack remote";

bool stands_in_viewer(const std::string& chain) {
  return spu::parse_chain(chain).back().name == "remote";
}

/// Returns the options of this run: from the environment, overridden by the command line.
spu::Options options_of(const RunArguments& arguments) {
  spu::Options options = spu::options_from_environment();
  for (const auto& [environment, value] : arguments.settings) spu::set_option(options, environment, value);
  return options;
}

/// Makes paths absolute, because the viewer may change its working directory.
std::string absolute_or_empty(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).string();
}

/// The loader splits its lists at these characters. If the path to the libraries contains one, the viewer
/// gets a symbolic link to them.
Installation within_a_list(Installation installation, const RunFolder& folder) {
  if (installation.libraries.string().find_first_of(" \t:;") == std::string::npos) return installation;
  const std::filesystem::path link = folder.path() / "lib";
  std::filesystem::create_directory_symlink(installation.libraries, link);
  installation.libraries = link;
  return installation;
}

Environment viewer_environment(const RunArguments& arguments, const spu::Options& options,
                               const Installation& installation, const RunFolder& folder,
                               const std::optional<NodeGroupPlan>& nodes) {
  Environment environment = current_environment();
  for (const auto& [name, value] : arguments.settings) environment[name] = value;
  environment["UNDERSTUDY_RUN_DIR"] = folder.path();
  environment["UNDERSTUDY_CHAIN"] = options.chain;
  // The launcher writes the report, from all processes of the run.
  environment.erase("UNDERSTUDY_REPORT");
  if (!options.save_frames.empty())
    environment["UNDERSTUDY_SAVE_FRAMES"] = absolute_or_empty(options.save_frames);
  if (!options.export_folder.empty())
    environment["UNDERSTUDY_EXPORT"] = absolute_or_empty(options.export_folder);
  if (nodes) {
    environment["UNDERSTUDY_NODES"] = std::to_string(nodes->placement.ranks);
    environment["UNDERSTUDY_CONNECT"] = nodes->socket;
  } else {
    environment.erase("UNDERSTUDY_NODES");
    environment.erase("UNDERSTUDY_CONNECT");
    if (!options.connect.empty()) environment["UNDERSTUDY_CONNECT"] = absolute_or_empty(options.connect);
  }
  if (!arguments.injection) return environment;
  const InjectionSettings injection = settings_of(*arguments.injection, within_a_list(installation, folder));
  if (std::filesystem::exists(injection.value)) {
    put_in_front(environment, injection.variable, injection.value);
  } else {
    say(fmt::format("{} is missing, so the viewer runs without Understudy; build it with ./run build",
                    injection.value.string()));
  }
  return environment;
}

/// Starts a GL server with the options of this run and no injection method; the viewer sends it all calls.
/// Returns the server, which must stay alive.
std::unique_ptr<ChildProcess> put_on_gl_server(const Installation& installation, Environment& viewer,
                                               const Environment& without_injection, const RunFolder& folder,
                                               const std::string& viewer_chain) {
  const std::filesystem::path socket = folder.path() / "gl_server.sock";
  auto server = start_gl_server(installation, socket, without_injection);
  viewer["UNDERSTUDY_REMOTE"] = socket;
  viewer["UNDERSTUDY_CHAIN"] = viewer_chain;
  return server;
}

/// Sets the environment of a viewer whose calls are executed on another machine.
void put_on_gl_server_elsewhere(Environment& viewer, const std::filesystem::path& socket,
                                const std::string& viewer_chain) {
  viewer["UNDERSTUDY_REMOTE"] = socket;
  viewer["UNDERSTUDY_CHAIN"] = viewer_chain;
  viewer.erase("UNDERSTUDY_CONNECT");
}

/// Returns the plan of the connection if --connect names another machine. Throws std::runtime_error for an
/// invalid address, and if there are no credentials.
std::optional<ConnectionPlan> connection_of(const RunArguments& arguments, const spu::Options& options) {
  if (options.connect.empty() || options.disable) return {};
  const auto address = compositor::tcp_address_of(options.connect);
  if (!address) return {};
  if (!arguments.connection.has_credentials()) throw std::runtime_error(lack_of_credentials(options.connect));
  ConnectionPlan plan = arguments.connection;
  plan.address = address->text();
  plan.connection_request.to =
      arguments.remote ? compositor::Destination::gl_server : compositor::Destination::nodes;
  compositor::ExchangeSettings settings;
  compositor::set_layout(settings, options.pixels);
  plan.connection_request.pixels = settings.layout;
  return plan;
}

/// Reports a connection that fails, but continues: nodes may start, or a wrong secret be corrected, while
/// the viewer draws by itself.
void tell_whether_connection_is_there(const ConnectionPlan& connection) {
  try {
    try_connection(connection);
  } catch (const std::runtime_error& error) {
    say(fmt::format("no render nodes at '{}': {}; the viewer draws by itself until they are available",
                    connection.address, error.what()));
  }
}

/// Returns -n, if it was given, even as 0.
std::optional<int> wished_nodes(const RunArguments& arguments, const spu::Options& options) {
  constexpr const char* variable = "UNDERSTUDY_NODES";
  if (arguments.settings.contains(variable) || std::getenv(variable) != nullptr) return options.nodes;
  return {};
}

/// Starts the nodes, if any are planned. If they cannot be started, the viewer runs without them.
std::unique_ptr<NodeGroup> start_nodes(const Installation& installation, std::optional<NodeGroupPlan>& plan) {
  if (!plan) return nullptr;
  std::string obstacle = obstacle_to_nodes(installation);
  if (obstacle.empty()) {
    try {
      return std::make_unique<NodeGroup>(installation, *plan);
    } catch (const std::exception& error) {
      obstacle = error.what();
    }
  }
  say(obstacle + "; rendering inside the viewer instead");
  plan.reset();
  return nullptr;
}

/// Tells the user if no group listens yet; one may still start. Only checks that the socket exists, because a
/// group takes any connection for a viewer.
void tell_whether_nodes_can_answer(const std::string& socket) {
  std::error_code unreadable;
  if (std::filesystem::is_socket(socket, unreadable)) return;
  say(
      fmt::format("no render nodes at '{}'; start them with: understudy serve -n N --socket {}; until then, "
                  "the viewer draws by itself",
                  socket, socket));
}

Ending wait_for(ChildProcess& viewer, NodeGroup* nodes, SignalInbox& inbox) {
  for (;;) {
    while (const std::optional<ReceivedSignal> received = inbox.next()) {
      if (received->number == SIGCHLD) {
        if (nodes != nullptr) nodes->look_after_children();
      } else if (!received->from_terminal) {
        viewer.signal(received->number);
      }
    }
    if (const std::optional<Ending> ending = viewer.poll_ending()) return *ending;
    if (nodes != nullptr) {
      nodes->wait_and_serve(inbox.descriptor());
    } else {
      pollfd waiting{inbox.descriptor(), POLLIN, 0};
      poll(&waiting, 1, -1);
    }
  }
}

/// Adds to the report what only the launcher has: the backends, and the TCP traffic.
std::string with_the_launchers(const std::string& report, const std::vector<std::string>& backends,
                               const nlohmann::ordered_json& connection) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(report);
  json[spu::report_key::origin] = origin();
  json[spu::report_key::backends] = backends;
  json[spu::report_key::connection] = connection;
  // File names in the command may be invalid UTF-8.
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void tell_what_happened(const spu::Options& options, bool quiet, const RunFolder& folder,
                        const RunFigures& figures) {
  const nlohmann::ordered_json connection = connection_figures(folder.path());
  const spu::Processes processes = figures.processes();
  const std::vector<std::string> backends = backend_choices(folder.path());
  if (options.explain) {
    std::fputs(spu::explanation_text(processes).c_str(), stderr);
    for (const std::string& choice : backends) say(choice);
    if (!connection.is_null()) say(connection_text(connection));
  }
  if (!quiet) std::fprintf(stderr, "%s\n", figures.summary().c_str());
  if (!options.export_folder.empty()) complete_exported_scenes(options.export_folder, folder.path(), processes);
  if (options.report.empty()) return;
  try {
    spu::replace_file(options.report, with_the_launchers(spu::report_json(processes), backends, connection));
  } catch (const std::exception& error) {
    say(error.what());
  }
}

/// If a viewer without a display failed before its first frame, reports that DISPLAY is not set.
void tell_of_a_missing_display(const Ending& ending, const RunFigures& figures) {
  if (ending.exit_status() == 0 || std::getenv("DISPLAY") != nullptr || figures.saw_frames()) return;
  say("DISPLAY is not set: a viewer with windows needs an X server, for example: Xvfb :99 -screen 0 "
      "1280x1024x24 +extension GLX -noreset & export DISPLAY=:99");
}

/// The run cannot start; the message says why and what to do.
class CannotRun : public std::runtime_error {
 public:
  explicit CannotRun(const std::string& why, int status = usage_error)
      : std::runtime_error(why), status_(status) {}
  int status() const { return status_; }

 private:
  int status_;
};

/// What is decided before anything is started.
struct RunPlan {
  spu::Options options;
  std::string viewer_chain = remote_chain;   ///< for a viewer whose calls a GL server executes
  std::optional<ConnectionPlan> connection;  ///< to another machine
  bool may_have_nodes = false;
  Placement placement;
};

/// Throws CannotRun for contradictory options.
void check_combination(const RunArguments& arguments, const spu::Options& options) {
  if (!arguments.remote && arguments.injection && stands_in_viewer(options.chain))
    throw CannotRun("a chain that ends in remote needs a GL server, which executes the calls; add --remote");
  if (arguments.remote && options.disable)
    throw CannotRun(
        "--remote and UNDERSTUDY_DISABLE exclude each other: without Understudy nothing executes the viewer's "
        "OpenGL calls; use only one of them");
  if (options.tiles && !arguments.remote)
    throw CannotRun("--tiles on needs a GL server, which draws the viewer's windows; add --remote");
}

/// Throws CannotRun.
std::optional<ConnectionPlan> checked_connection(const RunArguments& arguments, const spu::Options& options) {
  std::optional<ConnectionPlan> connection;
  try {
    connection = connection_of(arguments, options);
    // The viewer has no other OpenGL, so it is not started without a connection.
    if (connection && arguments.remote) try_connection(*connection);
  } catch (const std::runtime_error& error) {
    throw CannotRun(error.what(), connection ? 1 : usage_error);
  }
  if (!connection && arguments.connection.has_credentials())
    say("--secret-file and --key have no effect without --connect HOST:PORT; nodes and GL servers of this "
        "machine need neither");
  return connection;
}

/// Checks output files, because options from the environment have not been checked. Throws CannotRun.
void check_outputs(const spu::Options& options) {
  const std::string report = options.report.empty() ? "" : obstacle_to_writing(options.report);
  if (!report.empty()) throw CannotRun("--report: " + report);
  const std::string frames = options.save_frames.empty() ? "" : obstacle_to_writing_into(options.save_frames);
  if (!frames.empty()) throw CannotRun("--save-frames: " + frames);
  const std::string scenes =
      options.export_folder.empty() ? "" : obstacle_to_writing_into(options.export_folder);
  if (!scenes.empty()) throw CannotRun("--export: " + scenes);
}

/// Throws CannotRun.
RunPlan plan_of(const RunArguments& arguments) {
  RunPlan plan{.options = options_of(arguments)};
  spu::Options& options = plan.options;
  try {
    options.chain = spu::resolved_chain(options.chain, std::filesystem::current_path());
  } catch (const spu::ChainError& error) {
    throw CannotRun(error.what());
  }
  if (arguments.remote && stands_in_viewer(options.chain))
    plan.viewer_chain = std::exchange(options.chain, spu::Options().chain);
  check_combination(arguments, options);
  plan.connection = checked_connection(arguments, options);
  plan.may_have_nodes = options.connect.empty() && !options.disable;
  try {
    if (plan.may_have_nodes || !arguments.hostfile.empty())
      plan.placement =
          placement_of({wished_nodes(arguments, options), arguments.hostfile}, current_environment());
  } catch (const std::runtime_error& error) {
    throw CannotRun(error.what());
  }
  check_outputs(options);
  return plan;
}

/// Returns the plan of this run's nodes, if any.
std::optional<NodeGroupPlan> nodes_of(const RunArguments& arguments, const RunPlan& plan,
                                      const RunFolder& folder) {
  if (plan.placement.ranks == 0 || !plan.may_have_nodes) return {};
  const spu::Options& options = plan.options;
  return NodeGroupPlan{plan.placement,
                       folder.path() / "nodes.sock",
                       folder.path(),
                       {.exchange = options.exchange,
                        .pixels = options.pixels,
                        .gather = options.gather,
                        .overlap = options.overlap,
                        .backend = arguments.backend,
                        .gpu_memory = arguments.gpu_memory,
                        .sort = arguments.sort,
                        .partition = arguments.partition,
                        .balance = arguments.balance}};
}

/// Reports options that have no effect in this run.
void tell_options_without_effect(const RunArguments& arguments, const RunPlan& plan, bool has_nodes) {
  if (!has_nodes && arguments.backend != "cpu")
    say(fmt::format(
        "--backend {} has no effect without nodes of this run; add -n N, or give it to understudy serve. "
        "Inside the viewer's process, where OpenGL is the viewer's own, the CPU casts the rays",
        arguments.backend));
  if (!has_nodes && arguments.sort != "auto")
    say(fmt::format(
        "--sort {} has no effect without nodes of this run; add -n N, or give it to understudy serve",
        arguments.sort));
  if (!has_nodes && arguments.partition != "auto")
    say(fmt::format(
        "--partition {} has no effect without nodes of this run; add -n N, or give it to understudy serve",
        arguments.partition));
  if (!has_nodes && arguments.balance != "off")
    say(fmt::format(
        "--balance {} has no effect without nodes of this run; add -n N, or give it to understudy serve",
        arguments.balance));
  if (!has_nodes && !arguments.hostfile.empty())
    say(fmt::format("--hostfile {} has no effect without nodes of this run; give it to understudy serve",
                    arguments.hostfile.string()));
  const bool plays_here = arguments.remote ? !plan.connection : !arguments.injection;
  if (!plays_here && arguments.settings.contains("UNDERSTUDY_SERVER_OPENGL"))
    say(
        fmt::format("--server-opengl {} has no effect without a GL server of this run (--remote); for a GL "
                    "server elsewhere, give it to understudy serve --gl-server",
                    plan.options.server_opengl));
  if (plan.connection && arguments.remote && !plan.options.export_folder.empty())
    say("--export has no effect with a GL server elsewhere, where the volumes are recognised");
  if (plan.connection && plan.options.tiles)
    say("--tiles has no effect on a GL server elsewhere; give it to understudy serve --gl-server");
}

/// Starts the relay to another machine, if there is one; the viewer then connects to its socket.
std::unique_ptr<ChildProcess> start_connection(const RunArguments& arguments, RunPlan& plan,
                                               const Installation& installation, const RunFolder& folder,
                                               const std::filesystem::path& socket) {
  if (plan.connection) {
    if (!arguments.remote) tell_whether_connection_is_there(*plan.connection);
    auto relay = start_relay(installation, *plan.connection, socket, folder.path());
    plan.options.connect = socket;
    return relay;
  }
  if (!plan.options.connect.empty() && !plan.options.disable)
    tell_whether_nodes_can_answer(plan.options.connect);
  return nullptr;
}

/// Starts the GL server of this run, if it has one. Throws CannotRun if it cannot be started.
std::unique_ptr<ChildProcess> start_server(const RunArguments& arguments, const RunPlan& plan,
                                           const Installation& installation, const RunFolder& folder,
                                           const std::optional<NodeGroupPlan>& nodes,
                                           const std::filesystem::path& relay_socket, Environment& viewer) {
  if (!arguments.remote) return nullptr;
  if (plan.connection) {
    put_on_gl_server_elsewhere(viewer, relay_socket, plan.viewer_chain);
    return nullptr;
  }
  RunArguments without_injection = arguments;
  without_injection.injection.reset();
  try {
    return put_on_gl_server(installation, viewer,
                            viewer_environment(without_injection, plan.options, installation, folder, nodes),
                            folder, plan.viewer_chain);
  } catch (const std::exception& error) {
    throw CannotRun(fmt::format("{}; the viewer is not started, because it would have no OpenGL", error.what()),
                    1);
  }
}

/// Throws CannotRun.
ChildProcess start_viewer(const std::vector<std::string>& command, Environment environment) {
  try {
    return ChildProcess(Command{.arguments = command, .environment = std::move(environment)});
  } catch (const std::system_error& error) {
    throw CannotRun(error.what(),
                    error.code() == std::errc::permission_denied ? not_executable : cannot_start_viewer);
  }
}

int run_planned(const RunArguments& arguments, const std::vector<std::string>& command, RunPlan& plan) {
  if (!plan.options.save_frames.empty()) std::filesystem::create_directories(plan.options.save_frames);
  const Installation installation = this_installation();
  SignalInbox inbox({SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGCHLD});
  const RunFolder folder;
  std::optional<NodeGroupPlan> nodes_plan = nodes_of(arguments, plan, folder);
  tell_options_without_effect(arguments, plan, nodes_plan.has_value());
  std::unique_ptr<NodeGroup> nodes = start_nodes(installation, nodes_plan);
  const std::filesystem::path relay_socket = folder.path() / "link.sock";
  const std::unique_ptr<ChildProcess> relay =
      start_connection(arguments, plan, installation, folder, relay_socket);
  Environment environment = viewer_environment(arguments, plan.options, installation, folder, nodes_plan);
  const std::unique_ptr<ChildProcess> server =
      start_server(arguments, plan, installation, folder, nodes_plan, relay_socket, environment);
  ChildProcess viewer = start_viewer(command, std::move(environment));
  const Ending ending = wait_for(viewer, nodes.get(), inbox);
  if (server) server->end(server_patience_ms);
  if (relay) relay->end(server_patience_ms);
  nodes.reset();
  // Viewers that were killed leave their sockets.
  spu::remove_dead_control_sockets(spu::control_folder());
  const RunFigures figures(folder.path());
  tell_of_a_missing_display(ending, figures);
  tell_what_happened(plan.options, arguments.quiet, folder, figures);
  return arguments.required ? figures.required_status(ending.exit_status()) : ending.exit_status();
}

}  // namespace

int run(const RunArguments& arguments, const std::vector<std::string>& command) {
  try {
    RunPlan plan = plan_of(arguments);
    return run_planned(arguments, command, plan);
  } catch (const CannotRun& error) {
    say(error.what());
    return error.status();
  }
}

}  // namespace understudy::launcher
