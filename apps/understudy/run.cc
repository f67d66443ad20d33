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
#include "apps/understudy/environment.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/installation.h"
#include "apps/understudy/link_figures.h"
#include "apps/understudy/node_group.h"
#include "apps/understudy/node_options.h"
#include "apps/understudy/porter.h"
#include "apps/understudy/run_folder.h"
#include "apps/understudy/signal_inbox.h"
#include "apps/understudy/stage.h"
#include "apps/understudy/trace_option.h"
#include "compositor/exchange/settings.h"
#include "compositor/tcp/address.h"
#include "spu/assemble.h"
#include "spu/chain_text.h"
#include "spu/options.h"
#include "spu/report/keys.h"
#include "spu/report/report.h"

namespace understudy::launcher {
namespace {

constexpr int not_executable = 126;
constexpr int stage_patience_ms = 5000;
/// Of a viewer whose calls a stage makes: nothing is recognised in its own process. A chain that is to stand
/// there ends in link.
constexpr const char* remote_chain = "pack link";

bool stands_in_viewer(const std::string& chain) {
  return spu::parse_chain(chain).back().name == "link";
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
  if (!arguments.door) return environment;
  const DoorSettings door = settings_of(*arguments.door, installation);
  if (std::filesystem::exists(door.value)) {
    put_in_front(environment, door.variable, door.value);
  } else {
    say(fmt::format("{} is missing, so the viewer runs without Understudy; build it with ./run build",
                    door.value.string()));
  }
  return environment;
}

/// The stage has the options of this run and no door; the viewer hands it everything. Returns what must stay
/// alive.
std::unique_ptr<ChildProcess> put_on_stage(const Installation& installation, Environment& viewer,
                                           const Environment& without_door, const RunFolder& folder,
                                           const std::string& viewer_chain) {
  const std::filesystem::path socket = folder.path() / "stage.sock";
  auto stage = start_stage(installation, socket, without_door);
  viewer["UNDERSTUDY_REMOTE"] = socket;
  viewer["UNDERSTUDY_CHAIN"] = viewer_chain;
  return stage;
}

/// Of a viewer whose calls are made on another machine.
void put_on_stage_elsewhere(Environment& viewer, const std::filesystem::path& socket,
                            const std::string& viewer_chain) {
  viewer["UNDERSTUDY_REMOTE"] = socket;
  viewer["UNDERSTUDY_CHAIN"] = viewer_chain;
  viewer.erase("UNDERSTUDY_CONNECT");
}

/// How to get at what --connect names, if that is on another machine. Throws std::runtime_error for an address
/// that is none, and for one without a secret.
std::optional<LinkPlan> link_of(const RunArguments& arguments, const spu::Options& options) {
  if (options.connect.empty() || options.disable) return {};
  const auto address = compositor::tcp_address_of(options.connect);
  if (!address) return {};
  if (arguments.link.secret_file.empty())
    throw std::runtime_error(
        fmt::format("--connect {0} needs --secret-file FILE: the one that understudy serve --listen {0} uses, "
                    "copied to this machine",
                    options.connect));
  LinkPlan plan = arguments.link;
  plan.address = address->text();
  plan.wishes.to = arguments.remote ? compositor::LinkedTo::stage : compositor::LinkedTo::nodes;
  compositor::ExchangeSettings settings;
  compositor::set_layout(settings, options.pixels);
  plan.wishes.pixels = settings.layout;
  return plan;
}

/// Nodes elsewhere may come, and a wrong secret may be put right, while the viewer draws by itself.
void tell_whether_link_is_there(const LinkPlan& link) {
  try {
    try_link(link);
  } catch (const std::runtime_error& error) {
    say(fmt::format("no render nodes at '{}': {}; the viewer draws by itself until then", link.address,
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
                               const nlohmann::ordered_json& link) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(report);
  json[spu::report_key::backends] = backends;
  json[spu::report_key::link] = link;
  return json.dump(1, ' ') + "\n";
}

void tell_what_happened(const spu::Options& options, const RunFolder& folder) {
  const nlohmann::ordered_json link = link_figures(folder.path());
  const std::vector<spu::MappedCounters> counters = spu::read_counters(folder.path());
  std::vector<const spu::ProcessCounters*> processes;
  processes.reserve(counters.size());
  for (const spu::MappedCounters& process : counters) processes.push_back(process.get());
  const std::vector<std::string> backends = backend_choices(folder.path());
  if (options.explain) {
    std::fputs(spu::explanation_text(processes).c_str(), stderr);
    for (const std::string& choice : backends) say(choice);
    if (!link.is_null()) say(link_text(link));
  }
  std::fprintf(stderr, "%s\n", spu::summary_line(processes).c_str());
  if (options.report.empty()) return;
  try {
    spu::replace_file(options.report, with_the_launchers(spu::report_json(processes), backends, link));
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
  if (arguments.remote && options.disable) {
    say("--remote and UNDERSTUDY_DISABLE exclude each other: without Understudy the viewer's calls go nowhere; "
        "unset one of them");
    return usage_error;
  }
  if (options.polygons != "root" && !arguments.remote) {
    say("--polygons strips is for viewers whose windows are drawn elsewhere; add --remote");
    return usage_error;
  }
  std::optional<LinkPlan> link;
  try {
    link = link_of(arguments, options);
    // The viewer has no other OpenGL, and is better not started than without any.
    if (link && arguments.remote) try_link(*link);
  } catch (const std::runtime_error& error) {
    say(error.what());
    return link ? 1 : usage_error;
  }
  if (!link && !arguments.link.secret_file.empty())
    say("--secret-file is for --connect HOST:PORT; nodes and stages of this machine need no secret");
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
                          .home = options.home,
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
  const bool plays_here = arguments.remote ? !link : !arguments.door;
  if (!plays_here && arguments.settings.contains("UNDERSTUDY_STAGE_OPENGL"))
    say(
        fmt::format("--stage-opengl {} is for a stage of this run (--remote); for one elsewhere give it to "
                    "understudy serve --stage",
                    options.stage_opengl));
  if (link && options.polygons != "root")
    say(fmt::format(
        "--polygons {} is for a stage of this run; for one elsewhere give it to understudy serve --stage",
        options.polygons));
  std::unique_ptr<NodeGroup> nodes = start_nodes(installation, plan);
  std::unique_ptr<ChildProcess> porter;
  const std::filesystem::path link_socket = folder.path() / "link.sock";
  if (link) {
    if (!arguments.remote) tell_whether_link_is_there(*link);
    porter = start_porter(installation, *link, link_socket, folder.path());
    options.connect = link_socket;
  } else if (!options.connect.empty() && !options.disable) {
    tell_whether_nodes_can_answer(options.connect);
  }
  std::optional<ChildProcess> viewer;
  Environment environment = viewer_environment(arguments, options, installation, folder, plan);
  std::unique_ptr<ChildProcess> stage;
  if (arguments.remote && link) {
    put_on_stage_elsewhere(environment, link_socket, viewer_chain);
  } else if (arguments.remote) {
    RunArguments without_door = arguments;
    without_door.door.reset();
    try {
      stage = put_on_stage(installation, environment,
                           viewer_environment(without_door, options, installation, folder, plan), folder,
                           viewer_chain);
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
  if (stage) stage->end(stage_patience_ms);
  if (porter) porter->end(stage_patience_ms);
  nodes.reset();
  tell_what_happened(options, folder);
  return ending.exit_status();
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
  while (position < argc && std::strcmp(argv[position], "--") != 0) line.own.push_back(argv[position++]);
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
  add_link_options(*subcommand, arguments->link);
  const std::map<std::string, Door> doors{
      {"audit", Door::audit}, {"preload", Door::preload}, {"folder", Door::folder}};
  subcommand
      ->add_option("--door", arguments->door,
                   "how OpenGL calls are caught: audit (all of them), preload, folder")
      ->transform(CLI::CheckedTransformer(doors, CLI::ignore_case).description(""))
      ->type_name("audit|preload|folder");
  subcommand
      ->add_option("--trace", arguments->trace,
                   "record every call in FILE, for `understudy replay`; a further process of the viewer is "
                   "recorded in FILE.PID")
      ->type_name("FILE");
  subcommand->add_flag(
      "--remote", arguments->remote,
      "the viewer needs no OpenGL: its calls are made, and all is drawn, beside the nodes, and "
      "pictures come back to its windows; with --connect HOST:PORT on that machine (understudy serve --stage)");
  subcommand->callback([arguments, &viewer, &chosen] {
    chosen = [arguments, &viewer] { return run_viewer(*arguments, viewer); };
  });
}

}  // namespace understudy::launcher
