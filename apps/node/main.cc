// understudy-node: one rank of a node group, started by mpirun on behalf of the launcher.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <string>
#include <thread>

#include "compositor/exchange/mpi_link.h"
#include "compositor/node/node.h"

int main(int argc, char** argv) {
  using namespace understudy::compositor;
  CLI::App app(
      "One rank of Understudy's node group; `understudy serve` starts it as mpirun -n N understudy-node ...");
  std::string control;
  app.add_option("--control", control, "The launcher's Unix socket")->required();
  ExchangeSettings exchange;
  const auto choice = [&](const char* flag, bool (*set)(ExchangeSettings&, std::string_view),
                          const char* help) {
    app.add_option_function<std::string>(
        flag,
        [&exchange, flag, set](const std::string& name) {
          if (!set(exchange, name)) throw CLI::ValidationError(flag, "there is no '" + name + "'");
        },
        help);
  };
  choice("--exchange", set_algorithm, "How partial images become one");
  choice("--pixels", set_layout, "What numbers travel between ranks");
  CLI11_PARSE(app, argc, argv);

  MpiLink link(argc, argv);
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    std::max(1U, cores / unsigned(link.ranks_on_this_machine())));
  try {
    return run_node(link, control, limits::stall_patience, exchange) ? 0 : 1;
  } catch (const std::exception& error) {
    link.abandon(error.what());
  }
}
