#include "apps/understudy/node_options.h"

#include <fmt/format.h>

#include "spu/options.h"

namespace understudy::launcher {
namespace {

void add_node_option(CLI::App& subcommand, const std::string& flag, std::string& value) {
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

void add_exchange_options(CLI::App& subcommand, std::string& exchange, std::string& pixels) {
  add_node_option(subcommand, "--exchange", exchange);
  add_node_option(subcommand, "--pixels", pixels);
}

}  // namespace understudy::launcher
