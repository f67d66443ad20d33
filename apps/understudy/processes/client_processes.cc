// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/client_processes.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <exception>
#include <optional>
#include <thread>
#include <utility>

#include "compositor/logging/log.h"
#include "compositor/service/limits.h"
#include "compositor/transport/socket.h"
#include "compositor/transport/socket_file.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds patience_with_ends{1};

}  // namespace

bool ClientProcesses::start(const std::function<int()>& work) {
  const pid_t listening = ::getpid();
  const pid_t child = ::fork();
  if (child > 0) processes_.insert(child);
  if (child != 0) return child > 0;
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != listening) ::_exit(1);
  int status = 1;
  try {
    status = work();
  } catch (const std::exception& error) {
    logging::log(logging::Level::warn, "{}", error.what());
  }
  std::fflush(nullptr);
  ::_exit(status);
}

void ClientProcesses::reap() {
  std::erase_if(processes_, [](pid_t process) { return ::waitpid(process, nullptr, WNOHANG) != 0; });
}

ClientProcesses::~ClientProcesses() {
  const auto until = Clock::now() + patience_with_ends;
  for (reap(); !processes_.empty() && Clock::now() < until; reap())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

bool asked_to_end(SignalInbox& inbox, ClientProcesses& clients) {
  while (const std::optional<ReceivedSignal> received = inbox.next()) {
    if (received->number != SIGCHLD) return true;
    clients.reap();
  }
  return false;
}

void listen_for_clients(const std::string& socket, const std::string& who,
                        const std::function<int(compositor::FileDescriptor)>& work) {
  SignalInbox inbox({SIGTERM, SIGINT, SIGHUP, SIGCHLD});
  compositor::FileDescriptor listener = compositor::listen_at(socket);
  const compositor::SocketFile file(socket);
  ClientProcesses clients;
  while (!asked_to_end(inbox, clients)) {
    std::array<pollfd, 2> waiting = {{{listener.get(), POLLIN, 0}, {inbox.descriptor(), POLLIN, 0}}};
    ::poll(waiting.data(), waiting.size(), -1);
    if (waiting[0].revents == 0) continue;
    compositor::FileDescriptor client = compositor::accept_from(listener);
    if (!client) continue;
    if (clients.count() >= compositor::limits::max_clients) {
      logging::log(logging::Level::warn, "{}: {} applications are connected already; another one was rejected",
                   who, clients.count());
      continue;
    }
    clients.start([&] {
      listener.reset();
      return work(std::move(client));
    });
  }
}

}  // namespace understudy::launcher
