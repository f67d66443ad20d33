// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/print.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "apps/understudy/cli/play.h"
#include "compositor/logging/log.h"
#include "spu/print/record_text.h"
#include "spu/stream/event.h"
#include "spu/stream/trace_file.h"

namespace understudy::launcher {
namespace {

struct PrintArguments {
  std::filesystem::path trace;
  std::string frames;
  std::string calls;
};

int print(const PrintArguments& arguments) {
  const FrameRange range = arguments.frames.empty() ? FrameRange{} : parse_frame_range(arguments.frames);
  spu::TraceReader reader(arguments.trace);
  std::uint64_t frame = 1;
  bool read_on = true;
  const auto line = [&](std::string_view text) {
    if (!range.contains(frame)) return;
    read_on &=
        std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fputc('\n', stdout) != EOF;
  };
  std::function<bool(std::string_view)> wants_call;
  if (!arguments.calls.empty()) {
    wants_call = [&](std::string_view name) {
      return fnmatch(arguments.calls.c_str(), std::string(name).c_str(), 0) == 0;
    };
  }
  spu::RecordText text(line, wants_call);
  while (read_on && frame <= range.last) {
    const std::optional<spu::Block> block = reader.next();
    if (!block) break;
    std::size_t position = 0;
    while (read_on && position < block->records.size()) {
      const auto record = spu::record_at(block->records, position, block->payload);
      if (!record)
        throw std::runtime_error(fmt::format("{}: {}", arguments.trace.string(),
                                             in_block(*block, "a record is longer than its block")));
      text.tell(*record);
      if (record->id == spu::event::frame) ++frame;
      position += record->words.size();
    }
  }
  text.finish();
  // It is no error if the reader closes the pipe early, as head does.
  std::fflush(stdout);
  if (reader.cut_off())
    logging::log(logging::Level::warn, "{} was cut off; it was printed up to its last complete block",
                 arguments.trace.string());
  return 0;
}

}  // namespace

void add_print(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<PrintArguments>();
  CLI::App* subcommand = app.add_subcommand("print", "prints the calls and events of a trace, one per line");
  subcommand->add_option("trace", arguments->trace, "trace file")->required()->check(CLI::ExistingFile);
  subcommand->add_option("--frames", arguments->frames, "print only frames A to B, counted from 1")
      ->type_name("A-B");
  subcommand
      ->add_option("--calls", arguments->calls,
                   "print only calls whose names match this pattern, for example 'glTex*'")
      ->type_name("GLOB");
  subcommand->callback([arguments, &chosen] {
    if (!arguments->frames.empty()) parse_frame_range(arguments->frames);
    chosen = [arguments] { return print(*arguments); };
  });
}

}  // namespace understudy::launcher
