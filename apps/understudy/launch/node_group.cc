// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/node_group.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "apps/understudy/hosts/mpirun_command.h"
#include "apps/understudy/launch/say.h"
#include "apps/understudy/processes/environment.h"
#include "compositor/logging/log.h"
#include "compositor/service/backend_line.h"

namespace understudy::launcher {
namespace {

constexpr std::chrono::milliseconds housekeeping{
    1000};  ///< interval at which the broker drops silent pending clients
constexpr int patience_with_nodes_ms = 2000;
constexpr int patience_with_mpirun_ms = 5000;
constexpr std::chrono::seconds patience_with_lost_group{5};
constexpr std::uintmax_t max_log_read = 65536;
constexpr const char* nodes_log = "nodes.log";
/// In the private folder; only the nodes get its path.
constexpr const char* ranks_socket = "ranks.sock";
constexpr std::size_t max_backend_choices = 1024;

std::filesystem::path log_of(const NodeGroupPlan& plan) {
  return plan.folder / nodes_log;
}

std::uintmax_t size_of(const std::filesystem::path& path) {
  std::error_code none_yet;
  const std::uintmax_t size = std::filesystem::file_size(path, none_yet);
  return none_yet ? 0 : size;
}

std::string last_word(const std::string& line) {
  return line.substr(line.find_last_of(' ') + 1);
}

/// Returns the most informative line: a node's own message, otherwise mpirun's verdict;
/// empty if there is neither.
std::string last_words(const std::filesystem::path& log, std::uintmax_t from) {
  constexpr std::string_view from_node = "understudy-node: ";
  constexpr std::string_view from_mpirun = "mpirun noticed that ";
  std::ifstream file(log);
  const std::uintmax_t size = size_of(log);
  file.seekg(static_cast<std::streamoff>(size > from + max_log_read ? size - max_log_read : from));
  std::string verdict;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(from_node)) return line.substr(from_node.size());
    if (line.starts_with(from_mpirun)) verdict = line.substr(from_mpirun.size());
    if (line.starts_with("  Remote daemon: ")) verdict = "the connection to " + last_word(line) + " was lost";
    if (line.starts_with("ORTE was unable to reliably start one or more daemons"))
      verdict =
          "mpirun could not start Open MPI's daemon on every host: Open MPI must be installed there under the "
          "same path as here";
  }
  while (verdict.ends_with('.') || verdict.ends_with(' ')) verdict.pop_back();
  return verdict;
}

Command mpirun_command(const Installation& installation, const NodeGroupPlan& plan, const MpiLauncher& launcher,
                       const Placement& placement, const std::filesystem::path& folder) {
  Command command;
  command.arguments = mpirun_words(launcher, placement, folder);
  for (const std::string& word :
       {installation.node().string(), std::string("--control"), (plan.folder / ranks_socket).string()})
    command.arguments.push_back(word);
  for (const std::string& word : plan.choices.words()) command.arguments.push_back(word);
  command.environment =
      mpirun_environment(node_environment(current_environment(), installation), placement, folder);
  command.output = log_of(plan);
  command.own_group = true;
  return command;
}

/// An image whose application has disconnected may still take its time limit; only after that are
/// the ranks considered hung.
compositor::BrokerPatience patience_with(const NodeChoices& choices) {
  compositor::BrokerPatience patience;
  // Below the longest time that rank 0 can report.
  constexpr std::chrono::milliseconds most(compositor::limits::max_unwanted_ms - 5000);
  patience.unwanted = std::min(patience.unwanted + std::chrono::milliseconds(choices.image_ms), most);
  return patience;
}

std::string why_not_started(Launch launch) {
  if (launch == Launch::this_machine)
    return fmt::format("they did not start within {} s", patience_with_start.count());
  return fmt::format(
      "they did not connect to each other within {} s: every host must resolve the other hosts' names and "
      "reach their ports",
      patience_with_start.count());
}

/// Throws std::runtime_error.
MpiLauncher mpi_launcher() {
  const auto found = find_mpi_launcher(mpi_of_nodes().value_or(MpiFamily::open_mpi));
  if (const auto* const obstacle = std::get_if<std::string>(&found)) throw std::runtime_error(*obstacle);
  return std::get<MpiLauncher>(found);
}

bool is_on_path(const std::string& program) {
  return program.find('/') != std::string::npos ? std::filesystem::exists(program)
                                                : program_on_path(program).has_value();
}

}  // namespace

std::string obstacle_to_nodes(const Installation& installation) {
  const auto family = mpi_of_nodes();
  if (!family || !std::filesystem::exists(installation.node())) {
    return fmt::format("{} was not built (apt install libopenmpi-dev openmpi-bin, then ./run build)",
                       installation.node().string());
  }
  const auto found = find_mpi_launcher(*family);
  const auto* const obstacle = std::get_if<std::string>(&found);
  return obstacle != nullptr ? *obstacle : "";
}

std::vector<std::string> backend_choices(const std::filesystem::path& folder) {
  const std::string_view begin = compositor::backend_line;
  std::ifstream file(folder / nodes_log);
  std::vector<std::string> choices;
  for (std::string line; choices.size() < max_backend_choices && std::getline(file, line);)
    if (line.starts_with(begin)) choices.push_back(line.substr(begin.size()));
  return choices;
}

NodeGroup::NodeGroup(const Installation& installation, const NodeGroupPlan& plan)
    : installation_(installation),
      plan_(plan),
      broker_(
          {.applications = plan.socket, .nodes = plan.folder / ranks_socket},
          [this](const std::string& line) {
            // The loss of the group is reported once, with its reason, when mpirun has ended.
            if (broker_.lost())
              why_lost_ = line;
            else
              say(line);
          },
          patience_with(plan.choices)) {
  start();
}

NodeGroup::~NodeGroup() {
  if (!mpirun_) return;
  // A group whose connection closes ends by itself, and sooner than mpirun ends a group that it must signal.
  const bool ends_by_itself = broker_.node_group_ready();
  broker_.dismiss_node_group();
  if (ends_by_itself && mpirun_->wait_for_ending(patience_with_nodes_ms)) return;
  mpirun_->end(patience_with_mpirun_ms);
}

void NodeGroup::start() {
  if (plan_.placement.launch != Launch::remote_shell) return start_on(plan_.placement);
  const std::vector<Host> others(plan_.placement.hosts.begin() + 1, plan_.placement.hosts.end());
  const Environment environment = node_environment(current_environment(), installation_);
  probe_.emplace(others, launch_agent(environment, is_on_path), installation_.node(), environment,
                 plan_.folder);
}

void NodeGroup::start_on(const Placement& placement) {
  // Remove what a killed group has left now, not only at the end of the run. The next group gets a new
  // folder, because ranks of the last group that are still ending remove Open MPI's session folder while
  // the new mpirun creates it.
  std::error_code not_removed;
  std::filesystem::remove_all(group_folder_, not_removed);
  group_folder_ = plan_.folder / fmt::format("group-{}", ++groups_);
  std::filesystem::create_directories(shared_memory_folder(group_folder_));
  if (!launcher_) launcher_ = mpi_launcher();
  if (!placement.hosts.empty())
    std::ofstream(own_hostfile(group_folder_)) << own_hostfile_text(launcher_->version.family, placement.hosts);
  log_start_ = size_of(log_of(plan_));
  why_ended_.clear();
  started_at_ = Clock::now();
  mpirun_.emplace(mpirun_command(installation_, plan_, *launcher_, placement, group_folder_));
}

void NodeGroup::try_to(const std::function<void()>& start) {
  try {
    start();
  } catch (const std::exception& error) {
    broker_.turn_away(error.what());
    say(fmt::format("{}; the viewer continues by itself", error.what()));
  }
}

void NodeGroup::start_when_due() {
  if (!next_start_ || Clock::now() < *next_start_) return;
  next_start_.reset();
  try_to([this] { start(); });
}

void NodeGroup::start_on_hosts_that_answer() {
  if (!probe_ || !probe_->finished()) return;
  const std::vector<SilentHost> silent = probe_->silent();
  probe_.reset();
  std::vector<std::string> gone;
  std::string what;
  for (const SilentHost& host : silent) {
    gone.push_back(host.name);
    what += fmt::format("{}host {} {}", what.empty() ? "" : ", ", host.name, host.trouble);
  }
  const Placement placement = without_hosts(plan_.placement, gone);
  if (!silent.empty())
    say(fmt::format("{}: continuing with {} {} on {}", what, placement.ranks,
                    placement.ranks == 1 ? "node" : "nodes", names_of(placement.hosts)));
  try_to([&] { start_on(placement); });
}

void NodeGroup::wait_and_serve(int other) {
  std::vector<pollfd> descriptors{{other, POLLIN, 0}};
  broker_.poll_fds(descriptors);
  std::chrono::milliseconds wait = housekeeping;
  if (next_start_) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*next_start_ - Clock::now());
    wait = std::clamp(left, std::chrono::milliseconds(0), wait);
  }
  poll(descriptors.data(), descriptors.size(), static_cast<int>(wait.count()));
  const bool lost_before = broker_.lost();
  broker_.step(std::chrono::milliseconds(0));
  if (broker_.lost() && !lost_before) lost_at_ = Clock::now();
  end_what_hangs();
  start_on_hosts_that_answer();
  start_when_due();
}

void NodeGroup::end_what_hangs() {
  if (!mpirun_) return;
  // A group that has lost its rank 0 is ended by mpirun, which crashes if it is signalled while doing so
  // (4.1.4). So only a group that makes no progress is ended from here; look_after_children() notices its end.
  // Until this group is ready, broker_.lost() refers to the previous one.
  const bool was_there = broker_.lost() && started_at_ < lost_at_;
  const bool lost = was_there && Clock::now() > lost_at_ + patience_with_lost_group;
  // This applies on this machine, too: mpirun 4.1.4 occasionally hangs forever if a rank dies
  // before all have connected.
  const bool never_came = !was_there && !ready() && Clock::now() > started_at_ + patience_with_start;
  if (!lost && !never_came) return;
  why_ended_ = lost ? why_lost_ : why_not_started(plan_.placement.launch);
  mpirun_->end(patience_with_mpirun_ms);
  look_after_children();
}

void NodeGroup::look_after_children() {
  start_on_hosts_that_answer();
  if (!mpirun_) return;
  const std::optional<Ending> ending = mpirun_->poll_ending();
  if (!ending) return;
  mpirun_.reset();
  broker_.dismiss_node_group();
  const std::string words = why_ended_.empty() ? last_words(log_of(plan_), log_start_) : why_ended_;
  const std::string what =
      fmt::format("the render nodes are gone ({})", words.empty() ? "mpirun " + ending->text() : words);
  const auto pause = restarts_.after(Clock::now() - started_at_);
  if (!pause) {
    broker_.turn_away(what);
    say(fmt::format("{}; giving up after {} restarts, the viewer continues by itself", what,
                    restarts_.count()));
    return;
  }
  next_start_ = Clock::now() + *pause;
  const std::string where = plan_.placement.launch == Launch::remote_shell
                                ? "again on the hosts that answer"
                                : fmt::format("{} again", plan_.placement.ranks);
  say(fmt::format("{}; starting {} (attempt {} of {}), meanwhile the viewer draws by itself", what, where,
                  restarts_.count(), max_restarts));
}

}  // namespace understudy::launcher
