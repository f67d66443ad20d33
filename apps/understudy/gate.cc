#include "apps/understudy/gate.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "apps/understudy/client_processes.h"
#include "apps/understudy/environment.h"
#include "apps/understudy/signal_inbox.h"
#include "compositor/service/limits.h"
#include "compositor/tcp/gate.h"
#include "compositor/tcp/render_porter.h"
#include "spu/link/stage_porter.h"

namespace understudy::launcher {
namespace {

using compositor::Clock;
using compositor::Connection;
using compositor::FileDescriptor;
using compositor::Gate;
using compositor::LinkedTo;
using compositor::LinkVerdict;
using compositor::LinkWishes;
using compositor::TcpLink;
namespace limits = compositor::limits;

constexpr std::chrono::seconds patience_with_start{10};

void say(const std::string& line) {
  fmt::print(stderr, "understudy: {}\n", line);
}

/// The file in which a gate says where it listens.
std::filesystem::path address_file(const std::filesystem::path& folder) {
  return folder / "gate.address";
}

void tell_address(const std::filesystem::path& folder, const std::string& address) {
  const std::filesystem::path part = address_file(folder).string() + ".part";
  std::ofstream(part) << address;
  std::filesystem::rename(part, address_file(folder));
}

/// What the process of one client does. Returns its exit status.
int carry(FileDescriptor socket, const LinkWishes& wishes, const GatePlan& plan) {
  const bool to_stage = wishes.to == LinkedTo::stage;
  TcpLink link(std::move(socket), to_stage ? limits::max_stage_message_bytes : limits::max_message_bytes);
  const std::filesystem::path& path = to_stage ? plan.stage : plan.nodes;
  try {
    Connection here(compositor::connect_to(path.string(), Clock::now() + limits::hello_patience),
                    to_stage ? limits::max_stage_message_bytes : limits::max_message_bytes);
    std::string why;
    if (to_stage)
      why = spu::StagePorter(here, link, wishes).run();
    else
      why = compositor::NodesPorter(here, link, wishes).run();
    if (!why.empty()) say(fmt::format("dropped a client: {}", why));
    return why.empty() ? 0 : 1;
  } catch (const std::exception& error) {
    const std::vector<std::byte> text = compositor::encode_text(error.what());
    const compositor::Bytes payload(text);
    link.send(compositor::MessageType::refused, 0, {&payload, 1});
    say(error.what());
  }
  return 1;
}

int listen(const GatePlan& plan) {
  SignalInbox inbox({SIGTERM, SIGINT, SIGHUP, SIGCHLD});
  const compositor::Secret secret = compositor::read_secret(plan.secret_file);
  ClientProcesses clients;
  Gate* open_gate = nullptr;
  const auto judge = [&](const LinkWishes& wishes) {
    if (wishes.to == LinkedTo::stage && plan.stage.empty()) return LinkVerdict::not_offered;
    return clients.count() < limits::max_clients ? LinkVerdict::welcome : LinkVerdict::too_many;
  };
  const auto welcome = [&](FileDescriptor socket, const LinkWishes& wishes) {
    const bool started = clients.start([&] {
      open_gate->forget();
      return carry(std::move(socket), wishes, plan);
    });
    if (!started) say("no process can be made for a client; it was sent away");
  };
  Gate gate(plan.address, secret, judge, welcome, say);
  open_gate = &gate;
  tell_address(plan.folder, gate.address().text());
  while (!asked_to_end(inbox, clients)) {
    std::vector<pollfd> waiting = {{inbox.descriptor(), POLLIN, 0}};
    gate.poll_fds(waiting);
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(gate.next_deadline() - Clock::now());
    ::poll(waiting.data(), waiting.size(), int(std::max<long long>(left.count(), 0)));
    gate.step();
  }
  return 0;
}

}  // namespace

OpenGate start_gate(const Installation& installation, const GatePlan& plan) {
  std::vector<std::string> words = {installation.programs / "understudy",
                                    "gate",
                                    "--listen",
                                    plan.address.text(),
                                    "--secret-file",
                                    plan.secret_file,
                                    "--nodes",
                                    plan.nodes,
                                    "--folder",
                                    plan.folder};
  if (!plan.stage.empty()) words.insert(words.end(), {"--stage", plan.stage});
  OpenGate gate{
      std::make_unique<ChildProcess>(Command{.arguments = words, .environment = current_environment()}), {}};
  const auto until = Clock::now() + patience_with_start;
  while (!std::filesystem::exists(address_file(plan.folder))) {
    if (const auto ending = gate.process->wait_for_ending(5))
      throw std::runtime_error(
          fmt::format("nobody listens at {}: the gate {}", plan.address.text(), ending->text()));
    if (Clock::now() > until)
      throw std::runtime_error(fmt::format("nobody listens at {} in time", plan.address.text()));
  }
  std::string text;
  std::ifstream(address_file(plan.folder)) >> text;
  gate.address = compositor::tcp_address_of(text).value();
  return gate;
}

void add_gate(CLI::App& app, std::function<int()>& chosen) {
  const auto plan = std::make_shared<GatePlan>();
  const auto address = std::make_shared<std::string>();
  CLI::App* subcommand = app.add_subcommand("gate", "lets clients of other machines in, for serve --listen");
  subcommand->group("");
  subcommand->add_option("--listen", *address)->required();
  subcommand->add_option("--secret-file", plan->secret_file)->required();
  subcommand->add_option("--nodes", plan->nodes)->required();
  subcommand->add_option("--stage", plan->stage);
  subcommand->add_option("--folder", plan->folder)->required();
  subcommand->callback([plan, address, &chosen] {
    chosen = [plan, address] {
      plan->address = compositor::tcp_address_of(*address).value();
      return listen(*plan);
    };
  });
}

}  // namespace understudy::launcher
