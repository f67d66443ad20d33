// SPDX-License-Identifier: Apache-2.0
#include "spu/print/print.h"

#include <fnmatch.h>

#include <cerrno>
#include <cstring>
#include <sstream>

#include "compositor/logging/log.h"
#include "dispatch/call_words.h"
#include "spu/print/call_text.h"
#include "spu/shared_by_file.h"

namespace understudy::spu {

PrintFile::PrintFile(const std::string& name) : file_(name.empty() ? stderr : std::fopen(name.c_str(), "we")) {
  if (file_ != nullptr) return;
  logging::log(logging::Level::warn, "print: cannot write {}: {}; printing here instead", name,
               std::strerror(errno));
  file_ = stderr;
}

int PrintFile::begin_context() {
  const std::scoped_lock lock(mutex_);
  return ++contexts_;
}

void PrintFile::line(int context, std::string_view text) {
  const std::scoped_lock lock(mutex_);
  // Most applications have one context, so only further contexts are named.
  if (context > 1) fmt::print(file_, "[context {}] ", context);
  fmt::print(file_, "{}\n", text);
  std::fflush(file_);
}

struct Print::Printed {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    Print& print = *Chain::current()->find<Print>();
    const DispatchTable& next = print.chain_.below(print);
    const bool afterwards = shows_outcome(call);
    if (!afterwards) print.tell(call, words, 0);
    const std::uint64_t result = invoke(next, call, words);
    if (afterwards) print.chain_.after_call([&] { print.tell(call, words, result); });
    return result;
  }
};

Print::Print(Chain& chain, const std::string& file, IntegerRange frames, const std::string& calls)
    : chain_(chain),
      file_(shared_by_file<PrintFile>(file)),
      context_(file_.begin_context()),
      frames_(frames),
      wanted_(call_count) {
  std::istringstream patterns(calls);
  for (std::string pattern; patterns >> pattern;) {
    for (std::size_t i = 0; i < call_count; ++i) {
      if (fnmatch(pattern.c_str(), call_name(CallId(i)), 0) == 0) wanted_[i] = true;
    }
  }
}

void Print::tell(CallId call, const std::uint64_t* words, std::uint64_t result) {
  line_.clear();
  append_call(line_, call, words, result);
  file_.line(context_, {line_.data(), line_.size()});
}

void Print::fill(Phase, DispatchTable& table) {
  if (!prints()) return;
  DispatchTable printing{};
  AsWords<Printed>::fill(printing);
  for (std::size_t i = 0; i < call_count; ++i) {
    if (wanted_[i]) set_slot(table, CallId(i), slot(printing, CallId(i)));
  }
}

void Print::frame_ended(FrameEnd kind) {
  if (kind != FrameEnd::swap && kind != FrameEnd::finish) return;
  const bool printed = prints();
  if (printed) file_.line(context_, fmt::format("// frame {} ends", frame_));
  ++frame_;
  // Frames that are not printed cost nothing: their slots are the next unit's.
  if (printed != prints()) chain_.refill();
}

namespace {

constexpr UnitOption print_options[] = {
    {.name = "file",
     .type = OptionType::file,
     .fallback = "",
     .help = "file for the lines; default: standard error"},
    {.name = "frames",
     .type = OptionType::range,
     .fallback = "1-",
     .help = "frames to print, counted from 1; other frames cost nothing"},
    {.name = "calls",
     .type = OptionType::text,
     .fallback = "*",
     .help = "commands to print, as shell patterns separated by spaces: \"glTex* glBind*\""}};

}  // namespace

constinit const UnitDescription print_description{
    .name = "print",
    .help = "prints a line for every call, with the names of its arguments and of their values",
    .options = print_options,
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Print>(place.chain, place.options.text("file"), place.options.range("frames"),
                                     place.options.text("calls"));
    }};

}  // namespace understudy::spu
