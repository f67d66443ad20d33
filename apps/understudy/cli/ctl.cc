// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/ctl.h"

#include <fmt/format.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/understudy/control/running_viewers.h"
#include "apps/understudy/control/viewer_text.h"
#include "apps/understudy/launch/say.h"
#include "spu/control/control_message.h"
#include "spu/options.h"

namespace understudy::launcher {
namespace {

using Json = nlohmann::ordered_json;
using spu::ControlCommand;
using spu::ControlRequest;

struct CtlArguments {
  std::string action;
  std::vector<std::string> words;  ///< the viewer, if it is named, and a value
  bool json = false;
};

/// What one command line asks of which viewer.
struct Wish {
  std::string viewer;  ///< empty: the only one
  ControlRequest request;
};

std::string taken_last(std::vector<std::string>& words, const char* action, const char* what) {
  if (words.empty()) throw CLI::ValidationError(action, fmt::format("{} is missing", what));
  std::string last = std::move(words.back());
  words.pop_back();
  return last;
}

ControlRequest budget_in(std::vector<std::string>& words) {
  constexpr const char* what = "'error E', 'time T' or 'none'";
  ControlRequest request{.command = ControlCommand::budget, .error = "none", .time = "none"};
  const std::string value = taken_last(words, "set", what);
  if (value == "none" && (words.empty() || (words.back() != "error" && words.back() != "time"))) return request;
  const std::string name = taken_last(words, "set", what);
  if (name != "error" && name != "time")
    throw CLI::ValidationError("set", fmt::format("'{}' cannot be set; give {}", name, what));
  spu::Options scratch;
  if (!spu::set_option(scratch, name == "error" ? "UNDERSTUDY_ERROR" : "UNDERSTUDY_TIME", value))
    throw CLI::ValidationError("set", fmt::format("'{}' is not a value that --{} takes", value, name));
  (name == "error" ? request.error : request.time) = value;
  return request;
}

Wish wish_of(const CtlArguments& arguments) {
  std::vector<std::string> words = arguments.words;
  Wish wish;
  if (arguments.action == "on" || arguments.action == "off") {
    wish.request = {.command = ControlCommand::substitution, .on = arguments.action == "on"};
  } else if (arguments.action == "tint") {
    const std::string value = taken_last(words, "tint", "'on' or 'off'");
    if (value != "on" && value != "off")
      throw CLI::ValidationError("tint", fmt::format("'{}' is neither 'on' nor 'off'", value));
    wish.request = {.command = ControlCommand::tint, .on = value == "on"};
  } else if (arguments.action == "set") {
    wish.request = budget_in(words);
  }
  const std::size_t names = arguments.action == "list" ? 0 : 1;
  if (words.size() > names)
    throw CLI::ValidationError("ctl " + arguments.action,
                               fmt::format("'{}' is one word too many", words.back()));
  if (!words.empty()) wish.viewer = words.front();
  return wish;
}

void print(const Json& json) {
  fmt::print("{}\n", json.dump(1, ' ', false, Json::error_handler_t::replace));
}

int list(const CtlArguments& arguments) {
  const std::vector<RunningViewer> viewers = running_viewers();
  if (arguments.json) {
    Json all = Json::array();
    for (const RunningViewer& viewer : viewers) all.push_back(summary_of(viewer));
    print(all);
  } else {
    for (const RunningViewer& viewer : viewers) fmt::print("{}", summary_text(viewer));
    if (viewers.empty()) say("no viewer of yours runs under Understudy, or none has shown a frame yet");
  }
  return 0;
}

int ctl(const CtlArguments& arguments) {
  if (arguments.action == "list") return list(arguments);
  const Wish wish = wish_of(arguments);
  const std::vector<RunningViewer> viewers = running_viewers();
  const RunningViewer& viewer = chosen_viewer(viewers, wish.viewer);
  if (wish.request.command == ControlCommand::status) {
    if (arguments.json) {
      print(status_of(viewer));
    } else {
      fmt::print("{}", summary_text(viewer));
    }
    return 0;
  }
  const Json answer = ask(viewer.socket, wish.request);
  const Json control = answer.value("control", Json::object());
  if (arguments.json) {
    print(control);
  } else {
    fmt::print("{} ({}): {} from the next frame on\n", viewer.process, viewer.program(),
               settings_text(control));
  }
  return 0;
}

}  // namespace

void add_ctl(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<CtlArguments>();
  CLI::App* subcommand =
      app.add_subcommand("ctl",
                         "looks at viewers that run under Understudy, and changes what it does in them: "
                         "understudy ctl list|status|on|off|tint|set [VIEWER] [value]");
  subcommand
      ->add_option(
          "action", arguments->action,
          "list: all viewers; status: the figures so far; off, on: the viewer draws its volumes itself, "
          "Understudy substitutes them again; tint: on|off, as --debug-tint; set: error E, time T or "
          "none, as --error and --time")
      ->required()
      ->type_name("list|status|on|off|tint|set")
      ->check(CLI::IsMember({"list", "status", "on", "off", "tint", "set"}).description(""));
  subcommand
      ->add_option("words", arguments->words,
                   "process id or program name of the viewer, which may be left out if only one runs; then the "
                   "value of tint or set")
      ->type_name("[VIEWER] [value]");
  subcommand->add_flag("--json", arguments->json, "print JSON");
  subcommand->callback([arguments, &chosen] {
    wish_of(*arguments);
    chosen = [arguments] { return ctl(*arguments); };
  });
}

}  // namespace understudy::launcher
