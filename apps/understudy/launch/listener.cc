// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/listener.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "apps/understudy/launch/say.h"
#include "apps/understudy/processes/client_processes.h"
#include "apps/understudy/processes/environment.h"
#include "apps/understudy/processes/signal_inbox.h"
#include "compositor/logging/log.h"
#include "compositor/relay/render_relay.h"
#include "compositor/service/limits.h"
#include "compositor/service/service_protocols.h"
#include "compositor/transport/tcp/key_file.h"
#include "compositor/transport/tcp/listener.h"
#include "spu/remote/gl_server_relay.h"

namespace understudy::launcher {
namespace {

using compositor::AdmissionVerdict;
using compositor::Clock;
using compositor::Connection;
using compositor::ConnectionRequest;
using compositor::Destination;
using compositor::Listener;
using compositor::TcpConnection;
namespace limits = compositor::limits;

constexpr std::chrono::seconds patience_with_listener{10};

/// The file to which a listener writes its address.
std::filesystem::path address_file(const std::filesystem::path& folder) {
  return folder / "listener.address";
}

void tell_address(const std::filesystem::path& folder, const std::string& address) {
  const std::filesystem::path part = address_file(folder).string() + ".part";
  std::ofstream(part) << address;
  std::filesystem::rename(part, address_file(folder));
}

/// Relays one client's messages, in a process of its own. Returns its exit status.
int carry(compositor::AuthenticatedSocket client, const ConnectionRequest& connection_request,
          const ListenerPlan& plan) {
  const bool to_server = connection_request.to == Destination::gl_server;
  const compositor::Protocols spoken = to_server ? compositor::Protocols(spu::gl_server_protocols)
                                                 : compositor::Protocols(compositor::service_protocols);
  TcpConnection connection(std::move(client), spoken,
                           to_server ? limits::max_gl_server_message_bytes : limits::max_message_bytes);
  const std::filesystem::path& path = to_server ? plan.server : plan.nodes;
  try {
    Connection here(compositor::connect_to(path.string(), Clock::now() + limits::hello_patience), spoken,
                    to_server ? limits::max_gl_server_message_bytes : limits::max_message_bytes);
    std::string why;
    if (to_server)
      why = spu::GlServerRelay(here, connection, connection_request).run();
    else
      why = compositor::NodesRelay(here, connection, connection_request).run();
    if (!why.empty()) say(fmt::format("dropped a client: {}", why));
    return why.empty() ? 0 : 1;
  } catch (const std::exception& error) {
    const std::vector<std::byte> text = compositor::encode_text(error.what());
    const compositor::Bytes payload(text);
    connection.send(compositor::LauncherMessage::refused, 0, {&payload, 1});
    say(error.what());
  }
  return 1;
}

compositor::Credentials credentials_of(const ListenerPlan& plan) {
  std::optional<compositor::Secret> secret;
  if (!plan.secret_file.empty()) secret = compositor::read_secret(plan.secret_file);
  if (plan.key_file.empty()) return compositor::Credentials(secret.value());
  return {compositor::read_key_file(plan.key_file), compositor::read_public_keys(plan.clients), secret};
}

int listen(const ListenerPlan& plan) {
  SignalInbox inbox({SIGTERM, SIGINT, SIGHUP, SIGCHLD});
  const compositor::Credentials credentials = credentials_of(plan);
  ClientProcesses clients;
  Listener* open_listener = nullptr;
  const auto admission = [&](const ConnectionRequest& connection_request) {
    if (connection_request.to == Destination::gl_server && plan.server.empty())
      return AdmissionVerdict::not_offered;
    if (connection_request.plain && !plan.plain) return AdmissionVerdict::not_plain;
    return clients.count() < limits::max_clients ? AdmissionVerdict::accepted : AdmissionVerdict::too_many;
  };
  const auto accept = [&](compositor::AuthenticatedSocket client, const ConnectionRequest& connection_request) {
    const bool started = clients.start([&] {
      open_listener->forget();
      return carry(std::move(client), connection_request, plan);
    });
    if (!started) say("no process could be started for a client; the client was rejected");
  };
  Listener listener(plan.address, credentials, admission, accept, say);
  open_listener = &listener;
  tell_address(plan.folder, listener.address().text());
  while (!asked_to_end(inbox, clients)) {
    std::vector<pollfd> waiting = {{inbox.descriptor(), POLLIN, 0}};
    listener.poll_fds(waiting);
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(listener.next_deadline() - Clock::now());
    ::poll(waiting.data(), waiting.size(), int(std::max<long long>(left.count(), 0)));
    listener.step();
  }
  return 0;
}

}  // namespace

OpenListener start_listener(const Installation& installation, const ListenerPlan& plan) {
  std::vector<std::string> words = {installation.programs / "understudy",
                                    "listener",
                                    "--listen",
                                    plan.address.text(),
                                    "--nodes",
                                    plan.nodes,
                                    "--folder",
                                    plan.folder};
  if (!plan.server.empty()) words.insert(words.end(), {"--gl-server", plan.server});
  if (!plan.secret_file.empty()) words.insert(words.end(), {"--secret-file", plan.secret_file});
  if (!plan.key_file.empty()) words.insert(words.end(), {"--key", plan.key_file, "--clients", plan.clients});
  if (plan.plain) words.emplace_back("--plain");
  OpenListener listener{
      std::make_unique<ChildProcess>(Command{.arguments = words, .environment = current_environment()}), {}};
  const auto until = Clock::now() + patience_with_listener;
  while (!std::filesystem::exists(address_file(plan.folder))) {
    if (const auto ending = listener.process->wait_for_ending(5))
      throw std::runtime_error(
          fmt::format("cannot listen at {}: the listener {}", plan.address.text(), ending->text()));
    if (Clock::now() > until)
      throw std::runtime_error(
          fmt::format("cannot listen at {}: the listener did not start in time", plan.address.text()));
  }
  std::string text;
  std::ifstream(address_file(plan.folder)) >> text;
  listener.address = compositor::tcp_address_of(text).value();
  return listener;
}

void add_listener(CLI::App& app, std::function<int()>& chosen) {
  const auto plan = std::make_shared<ListenerPlan>();
  const auto address = std::make_shared<std::string>();
  CLI::App* subcommand =
      app.add_subcommand("listener", "accepts clients from other machines, for serve --listen");
  subcommand->group("");
  subcommand->add_option("--listen", *address)->required();
  subcommand->add_option("--secret-file", plan->secret_file);
  subcommand->add_option("--key", plan->key_file);
  subcommand->add_option("--clients", plan->clients);
  subcommand->add_option("--nodes", plan->nodes)->required();
  subcommand->add_option("--gl-server", plan->server);
  subcommand->add_flag("--plain", plan->plain);
  subcommand->add_option("--folder", plan->folder)->required();
  subcommand->callback([plan, address, &chosen] {
    chosen = [plan, address] {
      plan->address = compositor::tcp_address_of(*address).value();
      return listen(*plan);
    };
  });
}

}  // namespace understudy::launcher
