// SPDX-License-Identifier: Apache-2.0
// What `understudy ctl` asks a viewer that runs under Understudy, and the form of the answers: one JSON object
// per line in either direction (docs/control.md).
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace understudy::spu {

constexpr int control_version = 1;
constexpr std::size_t max_control_request_bytes = 4096;                   ///< of a line, with its end
constexpr std::size_t max_control_answer_bytes = std::size_t(16) << 20U;  ///< likewise

/// The names of the keys that every request and answer may have.
namespace control_key {
constexpr const char* version = "version";
constexpr const char* command = "command";
constexpr const char* on = "on";
constexpr const char* error = "error";  ///< of a request: a budget; of an answer: why it was refused
constexpr const char* time = "time";
constexpr const char* ok = "ok";
constexpr const char* control = "control";
constexpr const char* since = "since";
constexpr const char* substitution = "substitution";
constexpr const char* tint = "tint";
constexpr const char* time_ms = "time_ms";
constexpr const char* obstacle = "obstacle";
constexpr const char* report = "report";
}  // namespace control_key

enum class ControlCommand { status, substitution, tint, budget };

struct ControlRequest {
  ControlCommand command = ControlCommand::status;
  bool on = false;  ///< of substitution and tint
  /// Of a budget, as --error and --time take it; at least one is set.
  std::optional<std::string> error;
  std::optional<std::string> time;
  bool operator==(const ControlRequest&) const = default;
};

/// A line that is no request; the text says why.
class BadControlRequest : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns the request of a line without its end, which may come from anybody. Throws BadControlRequest.
ControlRequest control_request_in(std::string_view line);

/// Returns the line of a request, with its end.
std::string line_of(const ControlRequest& request);

/// Returns the line of an answer, with its end: `content` with the version and `ok`.
std::string control_answer(const nlohmann::ordered_json& content);
/// The same for a request that is refused.
std::string control_refusal(std::string_view reason);

}  // namespace understudy::spu
