// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/node_options.h"

#include <fmt/format.h>

#include "spu/options.h"

namespace understudy::launcher {
namespace {

void add_option_of_the_table(CLI::App& subcommand, const std::string& flag, std::string& value) {
  for (const spu::OptionText& option : spu::option_table()) {
    if (option.flag != flag) continue;
    const std::string variable = option.environment;
    subcommand.add_option(flag, value, option.help)
        ->envname(variable)
        ->type_name(option.value)
        ->capture_default_str()
        ->check([variable](const std::string& text) {
          spu::Options scratch;
          return spu::set_option(scratch, variable, text)
                     ? std::string()
                     : fmt::format("'{}' is not a value this option takes", text);
        });
  }
}

}  // namespace

void add_exchange_options(CLI::App& subcommand, NodeChoices& choices) {
  add_option_of_the_table(subcommand, "--exchange", choices.exchange);
  add_option_of_the_table(subcommand, "--pixels", choices.pixels);
  add_option_of_the_table(subcommand, "--gather", choices.gather);
  add_option_of_the_table(subcommand, "--overlap", choices.overlap);
}

void add_gl_server_option(CLI::App& subcommand, std::string& opengl) {
  add_option_of_the_table(subcommand, "--server-opengl", opengl);
}

void add_sandbox_option(CLI::App& subcommand, std::string& sandbox) {
  add_option_of_the_table(subcommand, "--sandbox", sandbox);
}

void add_tiles_option(CLI::App& subcommand, std::string& tiles) {
  add_option_of_the_table(subcommand, "--tiles", tiles);
}

void add_hostfile_option(CLI::App& subcommand, std::filesystem::path& hostfile) {
  subcommand
      .add_option(
          "--hostfile", hostfile,
          "file of the hosts to run MPI ranks on, among them this one: one host per line, as in 'node1 "
          "slots=2', comments after '#'; without -n, one rank per slot. Programs and libraries must be "
          "installed under the same path on all hosts, and the launch agent (ssh, or OMPI_MCA_plm_rsh_agent) "
          "must not ask for a password. MPI traffic between hosts is not encrypted: use trusted networks.")
      ->type_name("FILE");
}

}  // namespace understudy::launcher
