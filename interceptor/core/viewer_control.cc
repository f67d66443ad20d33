// SPDX-License-Identifier: Apache-2.0
#include "interceptor/core/viewer_control.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "spu/chain_text.h"
#include "spu/control/control_folder.h"
#include "spu/control/control_message.h"
#include "spu/options.h"
#include "spu/report/report.h"

namespace understudy::interceptor {
namespace {

using Json = nlohmann::ordered_json;
namespace key = spu::control_key;

/// Of a status; the report of the run has more of them.
constexpr std::size_t frames_of_status = 16;

/// Another viewer may remove the folder, as the last one, before the socket is in it.
constexpr int attempts_to_listen = 3;

constexpr std::chrono::milliseconds patience_at_end{50};

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

std::string obstacle_of(const spu::Options& options) {
  if (!options.remote.empty())
    return "a GL server executes this viewer's OpenGL and recognises its volumes (--remote), so it cannot be "
           "changed while it runs";
  const auto units = spu::parse_chain(options.chain);
  const bool has_volumes = std::ranges::any_of(units, [](const auto& unit) { return unit.name == "volume"; });
  return has_volumes ? "" : "the chain of this viewer has no volume unit, so there is nothing to change";
}

std::unique_ptr<spu::ControlServer> listen(const spu::ControlServer::Answer& answer) {
  const std::filesystem::path folder = spu::control_folder();
  for (int attempt = 1;; ++attempt) {
    try {
      spu::make_control_folder(folder);
      return std::make_unique<spu::ControlServer>(spu::control_socket(folder, ::getpid()), answer);
    } catch (const std::runtime_error&) {
      std::error_code unreadable;
      if (attempt == attempts_to_listen || std::filesystem::exists(folder, unreadable)) throw;
    }
  }
}

void apply(const spu::ControlRequest& request, spu::LiveSettings& settings) {
  if (request.command == spu::ControlCommand::substitution) settings.substitutes = request.on;
  if (request.command == spu::ControlCommand::tint) settings.tint = request.on;
  spu::Options options;
  options.error = settings.error;
  options.time_ms = settings.time_ms;
  if (request.error) spu::set_option(options, "UNDERSTUDY_ERROR", *request.error);
  if (request.time) spu::set_option(options, "UNDERSTUDY_TIME", *request.time);
  settings.error = options.error;
  settings.time_ms = options.time_ms;
}

Json json_of(const spu::LiveSettings& settings, const std::string& since, const std::string& obstacle) {
  const auto or_null = [](double value) { return value > 0 ? Json(value) : Json(nullptr); };
  return {{key::since, since},
          {key::substitution, settings.substitutes},
          {key::tint, settings.tint},
          {key::error, or_null(settings.error)},
          {key::time_ms, or_null(settings.time_ms)},
          {key::obstacle, obstacle.empty() ? Json(nullptr) : Json(obstacle)}};
}

}  // namespace

ViewerControl::ViewerControl(std::shared_ptr<spu::RenderSession> session)
    : session_(std::move(session)), since_(utc_now()), obstacle_(obstacle_of(session_->options())) {
  server_ = listen([this](std::string_view line) { return answer(line); });
}

void ViewerControl::stop() noexcept {
  server_->stop(patience_at_end);
}

std::string ViewerControl::answer(std::string_view line) {
  try {
    const spu::ControlRequest request = spu::control_request_in(line);
    const bool changes = request.command != spu::ControlCommand::status;
    if (changes && !obstacle_.empty()) return spu::control_refusal(obstacle_);
    if (changes) session_->wanted_settings().change([&](auto& settings) { apply(request, settings); });
    Json content{{key::control, json_of(session_->wanted_settings().get(), since_, obstacle_)}};
    if (!changes) content[key::report] = Json::parse(spu::running_report_json(frames_of_status));
    return spu::control_answer(content);
  } catch (const spu::BadControlRequest& bad) {
    return spu::control_refusal(bad.what());
  }
}

}  // namespace understudy::interceptor
