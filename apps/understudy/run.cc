#include "apps/understudy/run.h"

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

#include "apps/understudy/backend_option.h"
#include "apps/understudy/balance_option.h"
#include "apps/understudy/child_process.h"
#include "apps/understudy/connection_figures.h"
#include "apps/understudy/environment.h"
#include "apps/understudy/gl_server.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/installation.h"
#include "apps/understudy/node_group.h"
#include "apps/understudy/node_options.h"
#include "apps/understudy/relay.h"
#include "apps/understudy/run_figures.h"
#include "apps/understudy/run_folder.h"
#include "apps/understudy/signal_inbox.h"
#include "apps/understudy/trace_option.h"
#include "compositor/exchange/settings.h"
#include "compositor/transport/tcp/address.h"
#include "spu/chain_text.h"
#include "spu/former_names.h"
#include "spu/options.h"
#include "spu/registry/assemble.h"
#include "spu/report/keys.h"
#include "spu/report/report.h"

namespace understudy::launcher {
namespace {

constexpr int not_executable = 126;
constexpr int server_patience_ms = 5000;
/// Of a viewer whose calls a GL server makes: nothing is recognised in its own process. A chain that is to
/// stand there ends in remote.
constexpr const char* remote_chain = "pack remote";

bool stands_in_viewer(const std::string& chain) {
  return spu::parse_chain(chain).back().name == "remote";
}

void say(const std::string& line) {
  std::fprintf(stderr, "understudy: %s\n", line.c_str());
}

/// The options of this run: the environment's, and over them the command line's.
spu::Options options_of(const RunArguments& arguments) {
  spu::Options options = spu::options_from_environment();
  for (const auto& [environment, value] : arguments.settings) spu::set_option(options, environment, value);
  return options;
}

/// The viewer may change its folder: paths are told to it absolutely.
std::string absolute_or_empty(const std::string& path) {
  return path.empty() ? path : std::filesystem::absolute(path).string();
}

Environment viewer_environment(const RunArguments& arguments, const spu::Options& options,
                               const Installation& installation, const RunFolder& folder,
                               const std::optional<NodeGroupPlan>& nodes) {
  Environment environment = current_environment();
  for (const auto& [name, value] : arguments.settings) environment[name] = value;
  environment["UNDERSTUDY_RUN_DIR"] = folder.path();
  environment["UNDERSTUDY_CHAIN"] = options.chain;
  // The report is the launcher's to write, from all processes of the run.
  environment.erase("UNDERSTUDY_REPORT");
  if (!options.save_frames.empty())
    environment["UNDERSTUDY_SAVE_FRAMES"] = absolute_or_empty(options.save_frames);
  if (nodes) {
    environment["UNDERSTUDY_NODES"] = std::to_string(nodes->placement.ranks);
    environment["UNDERSTUDY_CONNECT"] = nodes->socket;
  } else {
    environment.erase("UNDERSTUDY_NODES");
    environment.erase("UNDERSTUDY_CONNECT");
    if (!options.connect.empty()) environment["UNDERSTUDY_CONNECT"] = absolute_or_empty(options.connect);
  }
  if (!arguments.injection) return environment;
  const InjectionSettings injection = settings_of(*arguments.injection, installation);
  if (std::filesystem::exists(injection.value)) {
    put_in_front(environment, injection.variable, injection.value);
  } else {
    say(fmt::format("{} is missing, so the viewer runs without Understudy; build it with ./run build",
                    injection.value.string()));
  }
  return environment;
}

/// The GL server has the options of this run and no injection method; the viewer hands it everything. Returns
/// what must stay alive.
std::unique_ptr<ChildProcess> put_on_gl_server(const Installation& installation, Environment& viewer,
                                               const Environment& without_injection, const RunFolder& folder,
                                               const std::string& viewer_chain) {
  const std::filesystem::path socket = folder.path() / "gl_server.sock";
  auto server = start_gl_server(installation, socket, without_injection);
  viewer["UNDERSTUDY_REMOTE"] = socket;
  viewer["UNDERSTUDY_CHAIN"] = viewer_chain;
  return server;
}

/// Of a viewer whose calls are made on another machine.
void put_on_gl_server_elsewhere(Environment& viewer, const std::filesystem::path& socket,
                                const std::string& viewer_chain) {
  viewer["UNDERSTUDY_REMOTE"] = socket;
  viewer["UNDERSTUDY_CHAIN"] = viewer_chain;
  viewer.erase("UNDERSTUDY_CONNECT");
}

/// How to get at what --connect names, if that is on another machine. Throws std::runtime_error for an address
/// that is none, and for one without a secret.
std::optional<ConnectionPlan> connection_of(const RunArguments& arguments, const spu::Options& options) {
  if (options.connect.empty() || options.disable) return {};
  const auto address = compositor::tcp_address_of(options.connect);
  if (!address) return {};
  if (arguments.connection.secret_file.empty())
    throw std::runtime_error(
        fmt::format("--connect {0} needs --secret-file FILE: the one that understudy serve --listen {0} uses, "
                    "copied to this machine",
                    options.connect));
  ConnectionPlan plan = arguments.connection;
  plan.address = address->text();
  plan.connection_request.to =
      arguments.remote ? compositor::Destination::gl_server : compositor::Destination::nodes;
  compositor::ExchangeSettings settings;
  compositor::set_layout(settings, options.pixels);
  plan.connection_request.pixels = settings.layout;
  return plan;
}

/// Nodes elsewhere may come, and a wrong secret may be put right, while the viewer draws by itself.
void tell_whether_connection_is_there(const ConnectionPlan& connection) {
  try {
    try_connection(connection);
  } catch (const std::runtime_error& error) {
    say(fmt::format("no render nodes at '{}': {}; the viewer draws by itself until then", connection.address,
                    error.what()));
  }
}

/// -n, if it was given: 0 of them is a wish too.
std::optional<int> wished_nodes(const RunArguments& arguments, const spu::Options& options) {
  constexpr const char* variable = "UNDERSTUDY_NODES";
  if (arguments.settings.contains(variable) || std::getenv(variable) != nullptr) return options.nodes;
  return {};
}

/// Nodes are a help, never a condition: whatever keeps them from starting, the viewer runs.
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

/// A group that is not there yet may still come; its user should know that it is not. The socket is only looked
/// at: a group takes whoever connects for a viewer.
void tell_whether_nodes_can_answer(const std::string& socket) {
  std::error_code unreadable;
  if (std::filesystem::is_socket(socket, unreadable)) return;
  say(fmt::format(
      "no render nodes at '{}'; start them with: understudy serve -n N --socket {}; the viewer draws by "
      "itself until then",
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

/// The report, with what only the launcher knows: who cast the rays, and what went over TCP.
std::string with_the_launchers(const std::string& report, const std::vector<std::string>& backends,
                               const nlohmann::ordered_json& connection) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(report);
  json[spu::report_key::backends] = backends;
  json[spu::report_key::connection] = connection;
  return json.dump(1, ' ') + "\n";
}

void tell_what_happened(const spu::Options& options, const RunFolder& folder, const RunFigures& figures) {
  const nlohmann::ordered_json connection = connection_figures(folder.path());
  const spu::Processes processes = figures.processes();
  const std::vector<std::string> backends = backend_choices(folder.path());
  if (options.explain) {
    std::fputs(spu::explanation_text(processes).c_str(), stderr);
    for (const std::string& choice : backends) say(choice);
    if (!connection.is_null()) say(connection_text(connection));
  }
  std::fprintf(stderr, "%s\n", figures.summary().c_str());
  if (options.report.empty()) return;
  try {
    spu::replace_file(options.report, with_the_launchers(spu::report_json(processes), backends, connection));
  } catch (const std::exception& error) {
    say(error.what());
  }
}

int run_viewer(RunArguments arguments, const std::vector<std::string>& command) {
  if (command.empty()) {
    say("which viewer? Put -- before its command: understudy run [options] -- viewer args…");
    return usage_error;
  }
  if (!arguments.trace.empty()) prepare_trace(arguments);
  const int status = run(arguments, command);
  if (!arguments.trace.empty()) say(trace_summary(arguments.trace));
  return status;
}

}  // namespace

int run(const RunArguments& arguments, const std::vector<std::string>& command) {
  spu::Options options = options_of(arguments);
  try {
    options.chain = spu::resolved_chain(options.chain, std::filesystem::current_path());
  } catch (const spu::ChainError& error) {
    say(error.what());
    return usage_error;
  }
  std::string viewer_chain = remote_chain;
  if (arguments.remote && stands_in_viewer(options.chain))
    viewer_chain = std::exchange(options.chain, spu::Options().chain);
  if (!arguments.remote && arguments.injection && stands_in_viewer(options.chain)) {
    say("a chain that ends in connection is for viewers whose calls are made elsewhere; add --remote");
    return usage_error;
  }
  if (arguments.remote && options.disable) {
    say("--remote and UNDERSTUDY_DISABLE exclude each other: without Understudy the viewer's calls go nowhere; "
        "unset one of them");
    return usage_error;
  }
  if (options.tiles && !arguments.remote) {
    say("--tiles on is for viewers whose windows are drawn elsewhere; add --remote");
    return usage_error;
  }
  std::optional<ConnectionPlan> connection;
  try {
    connection = connection_of(arguments, options);
    // The viewer has no other OpenGL, and is better not started than without any.
    if (connection && arguments.remote) try_connection(*connection);
  } catch (const std::runtime_error& error) {
    say(error.what());
    return connection ? 1 : usage_error;
  }
  if (!connection && !arguments.connection.secret_file.empty())
    say("--secret-file is for --connect HOST:PORT; nodes and GL servers of this machine need no secret");
  const bool may_have_nodes = options.connect.empty() && !options.disable;
  Placement placement;
  try {
    if (may_have_nodes || !arguments.hostfile.empty())
      placement = placement_of({wished_nodes(arguments, options), arguments.hostfile}, current_environment());
  } catch (const std::runtime_error& error) {
    say(error.what());
    return usage_error;
  }
  if (!options.save_frames.empty()) std::filesystem::create_directories(options.save_frames);

  const Installation installation = this_installation();
  SignalInbox inbox({SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGCHLD});
  const RunFolder folder;
  std::optional<NodeGroupPlan> plan;
  if (placement.ranks > 0 && may_have_nodes) {
    plan = NodeGroupPlan{placement,
                         folder.path() / "nodes.sock",
                         folder.path(),
                         {.exchange = options.exchange,
                          .pixels = options.pixels,
                          .gather = options.gather,
                          .overlap = options.overlap,
                          .backend = arguments.backend,
                          .gpu_memory = arguments.gpu_memory,
                          .balance = arguments.balance}};
  } else if (arguments.backend != "cpu") {
    say(fmt::format(
        "--backend {} is for nodes of this run (-n N), or give it to understudy serve; here rays are cast by "
        "the CPU, as the viewer's own process has OpenGL to itself",
        arguments.backend));
  }
  if (!plan && arguments.balance != "off")
    say(fmt::format("--balance {} is for nodes of this run (-n N), or give it to understudy serve",
                    arguments.balance));
  if (!plan && !arguments.hostfile.empty())
    say(fmt::format("--hostfile {} is for nodes of this run, or give it to understudy serve",
                    arguments.hostfile.string()));
  const bool plays_here = arguments.remote ? !connection : !arguments.injection;
  if (!plays_here && arguments.settings.contains("UNDERSTUDY_SERVER_OPENGL"))
    say(fmt::format(
        "--server-opengl {} is for a GL server of this run (--remote); for one elsewhere give it to "
        "understudy serve --gl-server",
        options.server_opengl));
  if (connection && options.tiles)
    say("--tiles is for a GL server of this run; for one elsewhere give it to understudy serve --gl-server");
  std::unique_ptr<NodeGroup> nodes = start_nodes(installation, plan);
  std::unique_ptr<ChildProcess> relay;
  const std::filesystem::path connection_socket = folder.path() / "link.sock";
  if (connection) {
    if (!arguments.remote) tell_whether_connection_is_there(*connection);
    relay = start_relay(installation, *connection, connection_socket, folder.path());
    options.connect = connection_socket;
  } else if (!options.connect.empty() && !options.disable) {
    tell_whether_nodes_can_answer(options.connect);
  }
  std::optional<ChildProcess> viewer;
  Environment environment = viewer_environment(arguments, options, installation, folder, plan);
  std::unique_ptr<ChildProcess> server;
  if (arguments.remote && connection) {
    put_on_gl_server_elsewhere(environment, connection_socket, viewer_chain);
  } else if (arguments.remote) {
    RunArguments without_injection = arguments;
    without_injection.injection.reset();
    try {
      server = put_on_gl_server(installation, environment,
                                viewer_environment(without_injection, options, installation, folder, plan),
                                folder, viewer_chain);
    } catch (const std::exception& error) {
      say(fmt::format("{}; the viewer has no OpenGL without it, so it is not started", error.what()));
      return 1;
    }
  }
  try {
    viewer.emplace(Command{.arguments = command, .environment = std::move(environment)});
  } catch (const std::system_error& error) {
    say(error.what());
    return error.code() == std::errc::permission_denied ? not_executable : cannot_start_viewer;
  }
  const Ending ending = wait_for(*viewer, nodes.get(), inbox);
  if (server) server->end(server_patience_ms);
  if (relay) relay->end(server_patience_ms);
  nodes.reset();
  const RunFigures figures(folder.path());
  tell_what_happened(options, folder, figures);
  return arguments.required ? figures.required_status(ending.exit_status()) : ending.exit_status();
}

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
      subcommand.add_option_function<std::string>(flag, take, help)->type_name(value);
    }
  }
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
  CLI::App* subcommand = app.add_subcommand("run", "runs a viewer: understudy run [options] -- viewer args…");
  subcommand->footer("Each option can also be given by the environment variable in brackets.");
  add_options_of_the_table(*subcommand, arguments);
  add_backend_option(*subcommand, arguments->backend);
  add_gpu_memory_option(*subcommand, arguments->gpu_memory);
  add_balance_option(*subcommand, arguments->balance);
  add_hostfile_option(*subcommand, arguments->hostfile);
  add_connection_options(*subcommand, arguments->connection);
  const std::map<std::string, InjectionMethod> injection_methods{{"audit", InjectionMethod::audit},
                                                                 {"preload", InjectionMethod::preload},
                                                                 {"folder", InjectionMethod::folder}};
  subcommand
      ->add_option("--injection", arguments->injection,
                   "how OpenGL calls are intercepted: audit (default; all of them), preload or folder")
      ->transform(CLI::CheckedTransformer(injection_methods, CLI::ignore_case).description(""))
      ->type_name("audit|preload|folder");
  subcommand
      ->add_option("--trace", arguments->trace,
                   "record every call in FILE for `understudy replay`; other processes of the viewer are "
                   "recorded in FILE.PID")
      ->type_name("FILE");
  subcommand->add_flag(
      "--remote", arguments->remote,
      "run a viewer without OpenGL: a GL server beside the nodes executes its calls and sends images to its "
      "windows; with --connect HOST:PORT on that machine (understudy serve --gl-server)");
  subcommand->add_flag("--require", arguments->required,
                       "exit with status 3 when no frame was substituted, with 4 when the GL server of "
                       "--remote was lost, unless the viewer's own status tells of a failure");
  subcommand->callback([arguments, &viewer, &chosen] {
    chosen = [arguments, &viewer] { return run_viewer(*arguments, viewer); };
  });
}

}  // namespace understudy::launcher
