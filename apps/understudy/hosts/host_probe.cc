// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/hosts/host_probe.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <optional>
#include <system_error>

#include "apps/understudy/processes/last_line.h"

namespace understudy::launcher {
namespace {

constexpr int patience_with_agent_ms = 1000;
constexpr std::size_t longest_words = 200;

std::string quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// ssh must not ask for a password, because no one sees the question, nor wait longer than this probe does.
std::vector<std::string> command_on(const std::string& host, std::vector<std::string> agent,
                                    const std::filesystem::path& node) {
  if (std::filesystem::path(agent.front()).filename() == "ssh")
    agent.insert(agent.end(), {"-x", "-o", "BatchMode=yes", "-o",
                               fmt::format("ConnectTimeout={}", patience_with_host.count() - 1)});
  agent.push_back(host);
  agent.push_back(quoted(node.string()) + " --help >/dev/null");
  return agent;
}

}  // namespace

HostProbe::HostProbe(const std::vector<Host>& hosts, const std::vector<std::string>& agent,
                     const std::filesystem::path& node, const Environment& environment,
                     const std::filesystem::path& folder)
    : node_(node), until_(std::chrono::steady_clock::now() + patience_with_host) {
  for (const Host& host : hosts) {
    const std::filesystem::path words = folder / fmt::format("host-{}", questions_.size());
    std::filesystem::remove(words);
    questions_.push_back(
        {host.name, words, ChildProcess({command_on(host.name, agent, node), environment, words, true})});
  }
}

bool HostProbe::finished() {
  const auto ended = [](Question& question) { return question.process.poll_ending().has_value(); };
  // All processes are polled, so that none of them stays a zombie.
  return std::ranges::count_if(questions_, ended) == std::ptrdiff_t(questions_.size()) ||
         std::chrono::steady_clock::now() > until_;
}

std::vector<SilentHost> HostProbe::silent() {
  constexpr int not_executable = 126;
  constexpr int not_found = 127;
  std::vector<SilentHost> silent;
  std::vector<std::optional<Ending>> endings;
  for (Question& question : questions_) {
    endings.push_back(question.process.poll_ending());
    if (!endings.back()) question.process.signal(SIGTERM);
  }
  for (std::size_t i = 0; i < questions_.size(); ++i) {
    Question& question = questions_[i];
    const bool in_time = endings[i].has_value();
    if (!in_time) question.process.end(patience_with_agent_ms);
    const int status = in_time ? endings[i]->exit_status() : -1;
    if (status == 0) continue;
    const std::string words = last_line(question.words).substr(0, longest_words);
    const std::string why = words.empty() ? "" : fmt::format(" ({})", words);
    if (!in_time)
      silent.push_back({question.host, fmt::format("does not answer within {} s", patience_with_host.count())});
    else if (status == not_executable || status == not_found)
      silent.push_back(
          {question.host,
           fmt::format(
               "cannot run {}{}: programs and libraries must be installed there under the same path as here",
               node_.string(), why)});
    else
      silent.push_back(
          {question.host,
           fmt::format("does not answer{}",
                       why.empty() ? fmt::format(" (the launch agent ended with status {})", status) : why)});
  }
  return silent;
}

}  // namespace understudy::launcher
