#include "apps/understudy/node_group.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "apps/understudy/environment.h"
#include "compositor/service/backend_line.h"

namespace understudy::launcher {
namespace {

constexpr std::chrono::milliseconds housekeeping{
    1000};  ///< the broker drops silent strangers at such intervals
constexpr int patience_with_nodes_ms = 2000;
constexpr int patience_with_mpirun_ms = 5000;
constexpr std::chrono::seconds patience_with_lost_group{5};
constexpr std::uintmax_t max_log_read = 65536;
constexpr const char* nodes_log = "nodes.log";
constexpr std::size_t max_backend_choices = 1024;

void say(const std::string& line) {
  std::fprintf(stderr, "understudy: %s\n", line.c_str());
}

std::filesystem::path log_of(const NodeGroupPlan& plan) {
  return plan.folder / nodes_log;
}

std::uintmax_t size_of(const std::filesystem::path& path) {
  std::error_code none_yet;
  const std::uintmax_t size = std::filesystem::file_size(path, none_yet);
  return none_yet ? 0 : size;
}

/// The one line that tells most: what a node said itself, else mpirun's verdict; empty when there is neither.
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
  }
  while (verdict.ends_with('.') || verdict.ends_with(' ')) verdict.pop_back();
  return verdict;
}

Command mpirun_command(const Installation& installation, const NodeGroupPlan& plan) {
  Command command;
  command.arguments = {"mpirun", "-n", std::to_string(plan.nodes),
                       // More ranks than cores are usual here, and each rank uses all the cores it finds.
                       "--oversubscribe", "--bind-to", "none",
                       // Ranks that wait must not keep the others from their cores.
                       "--mca", "mpi_yield_when_idle", "1",
                       // One machine: no remote shell is looked for, no network device is needed.
                       "--mca", "plm", "isolated", "--mca", "btl", "self,vader",
                       // Its session files go when the run's folder goes, whatever happens to it.
                       "--mca", "orte_tmpdir_base", plan.folder.string(), installation.node().string(),
                       "--control", plan.socket.string(), "--exchange", plan.exchange, "--pixels", plan.pixels,
                       "--home", plan.home, "--backend", plan.backend, "--gpu-memory", plan.gpu_memory,
                       "--balance", plan.balance};
  command.environment = node_environment(current_environment(), installation);
  command.output = log_of(plan);
  command.own_group = true;
  return command;
}

}  // namespace

std::string obstacle_to_nodes(const Installation& installation) {
  if (!program_on_path("mpirun")) {
    return "no MPI here (mpirun is not on PATH; apt install openmpi-bin libopenmpi-dev, then ./run build)";
  }
  if (!std::filesystem::exists(installation.node())) {
    return fmt::format("{} was not built (apt install libopenmpi-dev, then ./run build)",
                       installation.node().string());
  }
  return {};
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
    : installation_(installation), plan_(plan), broker_(plan.socket, [this](const std::string& line) {
        // The loss of the group is told once, with its reason, when mpirun has ended.
        if (!broker_.lost()) say(line);
      }) {
  start();
}

NodeGroup::~NodeGroup() {
  if (!mpirun_) return;
  // A group whose connection closes ends by itself, and sooner than mpirun ends one that it must signal.
  const bool ends_by_itself = broker_.node_group_ready();
  broker_.dismiss_node_group();
  if (ends_by_itself && mpirun_->wait_for_ending(patience_with_nodes_ms)) return;
  mpirun_->end(patience_with_mpirun_ms);
}

void NodeGroup::start() {
  log_start_ = size_of(log_of(plan_));
  mpirun_.emplace(mpirun_command(installation_, plan_));
}

void NodeGroup::start_when_due() {
  if (!next_start_ || Clock::now() < *next_start_) return;
  next_start_.reset();
  try {
    start();
  } catch (const std::exception& error) {
    broker_.turn_away(error.what());
    say(fmt::format("{}; the viewer goes on by itself", error.what()));
  }
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
  // A group that lost its rank 0 is ended by mpirun, which crashes when it is signalled in the midst of that
  // (4.1.4): only one that does not get anywhere is ended from here. Its end is seen in look_after_children.
  if (broker_.lost() && mpirun_ && Clock::now() > lost_at_ + patience_with_lost_group) {
    mpirun_->end(patience_with_mpirun_ms);
    look_after_children();
  }
  start_when_due();
}

void NodeGroup::look_after_children() {
  if (!mpirun_) return;
  const std::optional<Ending> ending = mpirun_->poll_ending();
  if (!ending) return;
  mpirun_.reset();
  broker_.dismiss_node_group();
  const std::string words = last_words(log_of(plan_), log_start_);
  const std::string what =
      fmt::format("the render nodes are gone ({})", words.empty() ? "mpirun " + ending->text() : words);
  if (restarts_ == max_restarts) {
    broker_.turn_away(what);
    say(fmt::format("{}; no more attempts after {} restarts, the viewer goes on by itself", what, restarts_));
    return;
  }
  next_start_ = Clock::now() + first_pause * (1 << restarts_);
  ++restarts_;
  say(fmt::format("{}; starting {} again ({} of {}), the viewer draws by itself meanwhile", what, plan_.nodes,
                  restarts_, max_restarts));
}

}  // namespace understudy::launcher
