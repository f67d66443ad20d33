// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/hosts/placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "apps/understudy/hosts/slurm_node_list.h"
#include "spu/options.h"

namespace understudy::launcher {
namespace {

std::string value_of(const Environment& environment, const std::string& name) {
  const auto found = environment.find(name);
  return found == environment.end() ? std::string() : found->second;
}

int tasks_of(const Environment& environment) {
  const std::string text = value_of(environment, "SLURM_NTASKS");
  int tasks = 0;
  std::from_chars(text.data(), text.data() + text.size(), tasks);
  return std::clamp(tasks, 0, spu::max_nodes);
}

Placement in_allocation(const PlacementWish& wish, const Environment& environment,
                        const std::function<bool(const std::string&)>& is_here) {
  const std::vector<std::string> nodes = slurm_nodes(value_of(environment, "SLURM_JOB_NODELIST"));
  Placement placement;
  placement.ranks = wish.ranks.value_or(0);
  // A shell on a login node may belong to an allocation elsewhere, but rank 0 must be on this machine.
  if (std::ranges::none_of(nodes, is_here)) return placement;
  // An interactive shell has one task, which does not request a group.
  if (const int tasks = tasks_of(environment); !wish.ranks && tasks > 1) placement.ranks = tasks;
  if (nodes.size() > 1) placement.launch = Launch::slurm;
  return placement;
}

}  // namespace

Placement placement_of(const PlacementWish& wish, const Environment& environment,
                       const std::function<bool(const std::string&)>& is_here) {
  const bool slurm = !value_of(environment, "SLURM_JOB_ID").empty();
  if (wish.hostfile.empty()) {
    if (slurm) return in_allocation(wish, environment, is_here);
    return {Launch::this_machine, wish.ranks.value_or(0), {}};
  }
  Placement placement;
  placement.hosts = read_hostfile(wish.hostfile);
  const auto here = std::ranges::find_if(placement.hosts, [&](const Host& host) { return is_here(host.name); });
  if (here == placement.hosts.end())
    throw std::runtime_error(
        fmt::format("hostfile '{}' lists {}, but not this machine, where rank 0 must share memory with the "
                    "viewer; add a line such as 'localhost slots=1', or start understudy on one of those hosts",
                    wish.hostfile.string(), names_of(placement.hosts)));
  std::rotate(placement.hosts.begin(), here, here + 1);
  const int slots = slots_of(placement.hosts);
  if (!wish.ranks && slots > spu::max_nodes)
    throw std::runtime_error(
        fmt::format("hostfile '{}' has {} slots, but a group can have at most {} ranks; give -n N",
                    wish.hostfile.string(), slots, spu::max_nodes));
  placement.ranks = wish.ranks.value_or(slots);
  if (placement.hosts.size() > 1) placement.launch = slurm ? Launch::slurm : Launch::remote_shell;
  return placement;
}

Placement without_hosts(const Placement& placement, const std::vector<std::string>& gone) {
  Placement left = placement;
  std::erase_if(left.hosts, [&](const Host& host) { return std::ranges::count(gone, host.name) > 0; });
  const int before = slots_of(placement.hosts);
  const int now = slots_of(left.hosts);
  if (placement.ranks > before)
    left.ranks = std::max(1, placement.ranks * now / before);
  else
    left.ranks = std::min(placement.ranks, now);
  if (left.hosts.size() == 1) left.launch = Launch::this_machine;
  return left;
}

}  // namespace understudy::launcher
