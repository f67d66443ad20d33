// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/loading_nodes.h"

#include <fmt/format.h>

#include <chrono>
#include <stdexcept>

#include "apps/understudy/cli/balance_option.h"
#include "apps/understudy/cli/node_options.h"
#include "apps/understudy/cli/partition_option.h"
#include "apps/understudy/cli/sort_option.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/launch/backend_option.h"
#include "apps/understudy/launch/own_node_group.h"
#include "apps/understudy/processes/environment.h"
#include "compositor/service/remote_service.h"
#include "compositor/transport/tcp/address.h"
#include "spu/options.h"

namespace understudy::launcher {
namespace {

/// Large volumes take long on busy machines.
constexpr std::chrono::minutes patience{10};

ServiceMaker linked_to(const std::string& address) {
  return [address] {
    return compositor::remote_loading_service(address, {patience, patience, patience, patience, patience});
  };
}

}  // namespace

void add_loading_nodes(CLI::App& subcommand, LoadingNodes& arguments) {
  CLI::Option* nodes =
      subcommand
          .add_option("-n,--nodes", arguments.nodes,
                      "number of MPI ranks to render on, which read the file themselves; default: the slots of "
                      "the hostfile or the tasks of the Slurm allocation, otherwise render in this process")
          ->check(CLI::Range(1, spu::max_nodes));
  add_hostfile_option(subcommand, arguments.hostfile);
  subcommand
      .add_option("--connect", arguments.connect,
                  "render on the nodes of `understudy serve`: its socket, or HOST:PORT")
      ->type_name("WHERE")
      ->excludes(nodes)
      ->excludes(subcommand.get_option("--hostfile"));
  add_connection_options(subcommand, arguments.connection);
  add_backend_option(subcommand, arguments.choices.backend);
  add_gpu_memory_option(subcommand, arguments.choices.gpu_memory);
  add_sort_option(subcommand, arguments.choices.sort);
  add_partition_option(subcommand, arguments.choices.partition);
  add_balance_option(subcommand, arguments.choices.balance);
  add_exchange_options(subcommand, arguments.choices);
}

bool ranks_are_here(const LoadingNodes& arguments) {
  if (!arguments.connect.empty()) return false;
  const Placement placement = placement_of({arguments.nodes, arguments.hostfile}, current_environment());
  return placement.ranks == 0 || placement.launch == Launch::this_machine;
}

std::vector<std::string> with_loading_nodes(
    const LoadingNodes& arguments,
    const std::function<void(const ServiceMaker& make, const std::stop_token& stop)>& job) {
  Placement placement;  // no ranks: render in this process
  if (arguments.connect.empty())
    placement = placement_of({arguments.nodes, arguments.hostfile}, current_environment());
  if (placement.ranks == 0 && arguments.choices.backend != "cpu")
    throw std::invalid_argument(fmt::format(
        "--backend {} has no effect without render nodes; add -n N, or give --backend to understudy serve",
        arguments.choices.backend));
  if (placement.ranks > 0)
    return with_own_nodes(
        {placement, arguments.choices},
        [&](const std::string& socket, const std::stop_token& stop) { job(linked_to(socket), stop); });
  if (compositor::tcp_address_of(arguments.connect)) {
    with_connection(arguments.connection, arguments.connect, arguments.choices.pixels,
                    [&](const std::string& socket) { job(linked_to(socket), {}); });
    return {};
  }
  job(arguments.connect.empty() ? ServiceMaker(compositor::embedded_loading_service)
                                : linked_to(arguments.connect),
      {});
  return {};
}

}  // namespace understudy::launcher
