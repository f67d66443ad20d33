// SPDX-License-Identifier: Apache-2.0
// understudy-node: one rank of a node group, started by mpirun on behalf of the launcher.
#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "compositor/exchange/mpi_communicator.h"
#include "compositor/logging/log.h"
#include "compositor/node/node.h"
#include "compositor/service/backend_line.h"
#include "compositor/service/client_limits.h"
#include "volume/glsl/backend.h"
#include "volume/glsl/brick_size.h"

namespace understudy {
namespace {

/// Returns the memory for texels of one client on this rank's machine, that is, on all ranks that
/// share bricks with this one.
std::uint64_t room_on_machine(const compositor::Communicator& communicator,
                              const compositor::ClientLimits& limits, int neighbours) {
  const std::vector<int> machines = communicator.machines();
  const auto sharing = std::uint64_t(std::ranges::count(machines, machines[std::size_t(communicator.rank())]));
  // Bricks take 1.5 times the memory of the texels.
  const std::uint64_t available = compositor::available_memory() / 2 * sharing / std::uint64_t(neighbours);
  return std::min(available, limits.bytes_of_client * sharing);
}

/// Raises the limit of descriptors to the maximum: each volume whose bricks are shared takes one.
void raise_descriptor_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

std::uint64_t least_over_ranks(compositor::Communicator& communicator, std::uint64_t mine) {
  std::vector<std::uint64_t> all(std::size_t(communicator.size()));
  communicator.gather_to_all(compositor::bytes_of(mine), std::as_writable_bytes(std::span(all)));
  return std::ranges::min(all);
}

struct NodeOptions {
  std::string control;
  compositor::ExchangeSettings exchange;
  std::string backend = "cpu";
  std::string gpu_memory = "auto";
  compositor::SortSettings sort;
  compositor::BalanceSettings balance;
  bool any_file = false;
  std::vector<std::string> data;
  int image_ms = 0;

  volume::ReadableFiles files() const {
    return any_file ? volume::ReadableFiles() : volume::ReadableFiles(data);
  }
};

void add_exchange_options(CLI::App& app, compositor::ExchangeSettings& exchange) {
  using namespace compositor;
  const auto choice = [&](const char* flag, bool (*set)(ExchangeSettings&, std::string_view),
                          const char* help) {
    app.add_option_function<std::string>(
        flag,
        [&exchange, flag, set](const std::string& name) {
          if (!set(exchange, name)) throw CLI::ValidationError(flag, "there is no '" + name + "'");
        },
        help);
  };
  choice("--exchange", set_algorithm, "algorithm that composites partial images");
  choice("--pixels", set_layout, "format of the pixels that ranks exchange");
  choice("--gather", set_gather, "path of the parts of an image to the application");
  choice("--overlap", set_overlap, "composite parts of an image while others are rendered: on, off or auto");
  choice("--packed", set_packed, "pack pixels before they are sent: on, off or auto");
}

void add_options(CLI::App& app, NodeOptions& options) {
  app.add_option("--control", options.control, "the launcher's Unix socket for nodes")->required();
  add_exchange_options(app, options.exchange);
  app.add_option("--backend", options.backend, "backend that casts the rays")
      ->check([](const std::string& name) -> std::string {
        if (volume::glsl::backend_of(name)) return {};
        return fmt::format("'{}' is not one of {}", name, volume::glsl::backend_names);
      });
  app.add_option("--gpu-memory", options.gpu_memory, "graphics memory for textures of volumes, in bytes")
      ->check(CLI::IsMember({"auto"}) | CLI::Range(volume::glsl::least_texture_memory, ~std::uint64_t(0)));
  app.add_option_function<std::string>(
      "--sort",
      [&sort = options.sort](const std::string& name) {
        if (!compositor::set_sort(sort, name))
          throw CLI::ValidationError("--sort", "there is no '" + name + "'");
      },
      "division of the work among ranks: last, first, hybrid or auto");
  app.add_option_function<std::string>(
      "--partition",
      [&sort = options.sort](const std::string& name) {
        if (!compositor::set_partition(sort, name))
          throw CLI::ValidationError("--partition", "there is no '" + name + "'");
      },
      "partition of a volume that ranks divide: blocks, factors, cost or auto");
  app.add_option_function<std::string>(
      "--balance",
      [&balance = options.balance.balance](const std::string& name) {
        if (!compositor::set_balance(balance, name))
          throw CLI::ValidationError("--balance", "there is no '" + name + "'");
      },
      "load balancing between ranks: off, muller or predicted");
  app.add_flag("--any-file", options.any_file, "applications may load every file that this user may read");
  app.add_option(
      "--data", options.data,
      "folders that applications may load volume files from; default: none, applications send their volumes");
  app.add_option(
         "--image-time", options.image_ms,
         "time limit of one image, in milliseconds, for nodes that independent applications share; 0: no limit")
      ->check(CLI::NonNegativeNumber);
}

void print_move(const compositor::MoveFigures& move) {
  const std::string reason = move.deviation ? fmt::format("because times deviated by {:.2f}", *move.deviation)
                                            : "by expected costs, before any time was measured";
  fmt::print(stderr,
             "node 0: volume {}: moved {} planes, {}; received {} blocks ({} bytes), reused {} earlier ones; "
             "{:.1f} ms\n",
             move.volume, move.planes, reason, move.blocks_received, move.bytes_received,
             move.blocks_from_cache, move.ms);
  std::fflush(stderr);
}

int run_rank(NodeOptions& options, int argc, char** argv) {
  using namespace compositor;
  raise_descriptor_limit();
  MpiCommunicator communicator(argc, argv);
  const int neighbours = communicator.ranks_on_this_machine();
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  // Rounded up: idle cores are worse than two threads on some of them.
  const unsigned share = (cores + unsigned(neighbours) - 1) / unsigned(neighbours);
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, share);
  // Otherwise Mesa's software renderer would use all cores on each rank.
  setenv("LP_NUM_THREADS", fmt::format("{}", share).c_str(), 0);
  volume::glsl::TextureMemoryWish memory;
  memory.sharers = neighbours;
  if (options.gpu_memory != "auto") memory.bytes = std::stoull(options.gpu_memory);
  volume::glsl::BackendChooser chooser(
      *volume::glsl::backend_of(options.backend),
      [&](const std::string& choice) {
        fmt::print(stderr, "{}node {}: {}\n", backend_line, communicator.rank(), choice);
        std::fflush(stderr);
      },
      memory);
  options.balance.memory_left = [&] { return compositor::available_memory() / std::size_t(neighbours); };
  options.balance.moved = [&](const MoveFigures& move) {
    if (communicator.rank() == 0) print_move(move);
  };
  // Balancing moves blocks between ranks that divide one copy of a volume, so it requires sort-last.
  if (options.balance.balance != Balance::off) options.sort.sort = Sort::last;
  try {
    const ClientLimits limits = client_limits(neighbours, std::chrono::milliseconds(options.image_ms));
    options.sort.bytes_of_machine =
        least_over_ranks(communicator, room_on_machine(communicator, limits, neighbours));
    return run_node(communicator, options.control,
                    {.exchange = options.exchange,
                     .make_renderer = chooser.factory(),
                     .sort = options.sort,
                     .balance = options.balance,
                     .files = options.files(),
                     .limits = limits})
               ? 0
               : 1;
  } catch (const std::exception& error) {
    communicator.abandon(error.what());
  }
}

}  // namespace
}  // namespace understudy

int main(int argc, char** argv) {
  understudy::logging::set_program("understudy-node");
  CLI::App app(
      "Renders as one rank of a group of nodes. `understudy` starts it as: mpirun -n N understudy-node ...");
  app.set_help_flag("-h,--help", "print this help and exit");
  understudy::NodeOptions options;
  understudy::add_options(app, options);
  CLI11_PARSE(app, argc, argv);
  return understudy::run_rank(options, argc, argv);
}
