// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/gl_server/client_process.h"

#include <poll.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <exception>
#include <list>
#include <thread>
#include <utility>
#include <vector>

#include "apps/understudy/gl_server/client_environment.h"
#include "apps/understudy/processes/signal_inbox.h"
#include "compositor/logging/log.h"
#include "compositor/service/limits.h"
#include "compositor/transport/connector.h"
#include "compositor/transport/socket.h"
#include "compositor/transport/socket_file.h"
#include "spu/options.h"

namespace understudy::launcher {
namespace {

using compositor::Clock;
using compositor::FileDescriptor;

constexpr std::chrono::seconds patience_with_end{1};

using ClientProcessList = std::list<ClientProcess>;

void reap(ClientProcessList& clients) {
  clients.remove_if([](ClientProcess& client) {
    const std::optional<Ending> ending = client.poll_ending();
    if (ending && WIFSIGNALED(ending->status) && WTERMSIG(ending->status) != SIGTERM)
      logging::log(logging::Level::warn, "GL server: the process of an application {}", ending->text());
    return ending.has_value();
  });
}

bool asked_to_end(SignalInbox& inbox, ClientProcessList& clients) {
  while (const std::optional<ReceivedSignal> received = inbox.next()) {
    if (received->number != SIGCHLD) return true;
    reap(clients);
  }
  return false;
}

/// Waits for the processes of clients that have just disconnected, which still write figures; then kills the
/// others, even if they ignore signals.
void end_all(ClientProcessList& clients) {
  const auto until = Clock::now() + patience_with_end;
  for (reap(clients); !clients.empty() && Clock::now() < until; reap(clients))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  for (const ClientProcess& client : clients) client.kill();
}

}  // namespace

ClientProcess::ClientProcess(const Installation& installation, const std::string& socket, FileDescriptor client,
                             const Environment& environment) {
  auto [ours, its] = compositor::connector_channel();
  process_.emplace(
      Command{.arguments = {installation.programs / "understudy", "gl-server", "--socket", socket, "--client",
                            std::to_string(client.get()), "--connector", std::to_string(its.get())},
              .environment = environment,
              .output = {},
              .own_group = false,
              .descriptors = {client.get(), its.get()},
              .confined = true});
  channel_ = std::move(ours);
}

void ClientProcess::connect_for_it(std::span<const std::string> allowed) {
  if (!compositor::answer_connector(channel_, allowed)) channel_.reset();
}

void serve_clients(const std::string& socket) {
  const Installation installation = this_installation();
  const spu::Options options = spu::options_from_environment();
  // Tile workers are clients of this GL server, too, so its own socket is reachable.
  std::vector<std::string> reachable = {socket};
  if (!options.connect.empty()) reachable.push_back(options.connect);
  const Environment environment =
      options.sandbox ? client_environment(current_environment()) : current_environment();
  SignalInbox inbox({SIGTERM, SIGINT, SIGHUP, SIGCHLD});
  FileDescriptor listener = compositor::listen_at(socket);
  const compositor::SocketFile file(socket);
  ClientProcessList clients;
  while (!asked_to_end(inbox, clients)) {
    std::vector<pollfd> waiting = {{listener.get(), POLLIN, 0}, {inbox.descriptor(), POLLIN, 0}};
    for (const ClientProcess& client : clients) waiting.push_back({client.channel(), POLLIN, 0});
    ::poll(waiting.data(), waiting.size(), -1);
    auto entry = waiting.begin() + 2;
    for (ClientProcess& client : clients) {
      if ((entry++)->revents != 0) client.connect_for_it(reachable);
    }
    if (waiting[0].revents == 0) continue;
    FileDescriptor client = compositor::accept_from(listener);
    if (!client) continue;
    if (clients.size() >= compositor::limits::max_clients) {
      logging::log(logging::Level::warn,
                   "gl-server: {} applications are connected already; another one was rejected",
                   clients.size());
      continue;
    }
    try {
      clients.emplace_back(installation, socket, std::move(client), environment);
    } catch (const std::exception& error) {
      logging::log(logging::Level::warn, "gl-server: no process could be started for another application: {}",
                   error.what());
    }
  }
  end_all(clients);
}

}  // namespace understudy::launcher
