// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/trace_option.h"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <stdexcept>

#include "spu/chain_text.h"
#include "spu/options.h"
#include "spu/registry/assemble.h"
#include "spu/stream/trace_file.h"

namespace understudy::launcher {

void prepare_trace(RunArguments& arguments) {
  spu::Options options = spu::options_from_environment();
  for (const auto& [environment, value] : arguments.settings) spu::set_option(options, environment, value);
  // A process that finds an existing file records to another one.
  if (std::filesystem::exists(arguments.trace) && !std::filesystem::is_regular_file(arguments.trace))
    throw std::runtime_error(fmt::format("--trace {}: a trace can only be written to a file; give another name",
                                         arguments.trace.string()));
  std::filesystem::remove(arguments.trace);
  const spu::UnitSetting trace{
      .name = "trace", .options = {{.name = "file", .value = std::filesystem::absolute(arguments.trace)}}};
  arguments.settings["UNDERSTUDY_CHAIN"] =
      spu::chain_text({trace}) + " " + spu::resolved_chain(options.chain, std::filesystem::current_path());
}

std::string trace_summary(const std::filesystem::path& trace) {
  const std::string name = trace.string();
  if (!std::filesystem::exists(trace))
    return fmt::format("{} was not written: no OpenGL context of the viewer was intercepted", name);
  try {
    spu::TraceReader reader(trace);
    std::uint64_t frames = 0;
    while (const auto block = reader.next()) frames += block->frames;
    return fmt::format("{}: {} frames, {:.1f} MB; play it with: understudy replay {}", name, frames,
                       double(std::filesystem::file_size(trace)) / 1e6, name);
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace understudy::launcher
