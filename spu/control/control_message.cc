// SPDX-License-Identifier: Apache-2.0
#include "spu/control/control_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "spu/options.h"

namespace understudy::spu {
namespace {

using Json = nlohmann::ordered_json;

struct CommandName {
  ControlCommand command;
  const char* name;
};

constexpr std::array commands{
    CommandName{ControlCommand::status, "status"}, CommandName{ControlCommand::substitution, "substitution"},
    CommandName{ControlCommand::tint, "tint"}, CommandName{ControlCommand::budget, "budget"}};

ControlCommand command_in(const Json& request) {
  const auto found = request.find(control_key::command);
  if (found == request.end() || !found->is_string())
    throw BadControlRequest("the request has no command: status, substitution, tint or budget");
  const auto& name = found->get_ref<const std::string&>();
  const auto command = std::ranges::find_if(commands, [&](const CommandName& row) { return name == row.name; });
  if (command == commands.end())
    throw BadControlRequest("the command is unknown; known are status, substitution, tint and budget");
  return command->command;
}

void require_this_version(const Json& request) {
  const auto version = request.find(control_key::version);
  if (version == request.end() || *version != control_version)
    throw BadControlRequest(fmt::format(
        "the request is not of version {}; use the `understudy` that started the viewer", control_version));
}

bool switch_in(const Json& request) {
  const auto on = request.find(control_key::on);
  if (on == request.end() || !on->is_boolean())
    throw BadControlRequest("the request does not say whether on is true or false");
  return on->get<bool>();
}

std::optional<std::string> budget_in(const Json& request, const char* key, const char* variable) {
  const auto value = request.find(key);
  if (value == request.end()) return {};
  Options scratch;
  if (!value->is_string() || !set_option(scratch, variable, value->get_ref<const std::string&>()))
    throw BadControlRequest(fmt::format("the value of {} is not one that --{} takes", key, key));
  return value->get<std::string>();
}

const char* name_of(ControlCommand command) {
  return std::ranges::find_if(commands, [&](const CommandName& row) { return command == row.command; })->name;
}

/// Text of other programs may be invalid UTF-8, which is replaced.
std::string as_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

ControlRequest control_request_in(std::string_view line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) throw BadControlRequest("the line is not a JSON object");
  require_this_version(json);
  ControlRequest request{.command = command_in(json)};
  switch (request.command) {
    case ControlCommand::status:
      break;
    case ControlCommand::substitution:
    case ControlCommand::tint:
      request.on = switch_in(json);
      break;
    case ControlCommand::budget:
      request.error = budget_in(json, control_key::error, "UNDERSTUDY_ERROR");
      request.time = budget_in(json, control_key::time, "UNDERSTUDY_TIME");
      if (!request.error && !request.time)
        throw BadControlRequest("the budget has neither an error nor a time");
      break;
  }
  return request;
}

std::string line_of(const ControlRequest& request) {
  Json json{{control_key::version, control_version}, {control_key::command, name_of(request.command)}};
  if (request.command == ControlCommand::substitution || request.command == ControlCommand::tint)
    json[control_key::on] = request.on;
  if (request.error) json[control_key::error] = *request.error;
  if (request.time) json[control_key::time] = *request.time;
  return as_line(json);
}

std::string control_answer(const Json& content) {
  Json json{{control_key::version, control_version}, {control_key::ok, true}};
  json.update(content);
  return as_line(json);
}

std::string control_refusal(std::string_view reason) {
  return as_line(
      Json{{control_key::version, control_version}, {control_key::ok, false}, {control_key::error, reason}});
}

}  // namespace understudy::spu
