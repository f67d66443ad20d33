// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/own_node_group.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <exception>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "apps/understudy/launch/node_group.h"
#include "apps/understudy/launch/run_folder.h"
#include "apps/understudy/processes/signal_inbox.h"
#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/socket.h"

namespace understudy::launcher {
namespace {

using compositor::FileDescriptor;

FileDescriptor checked(int descriptor) {
  if (descriptor < 0) throw std::system_error(errno, std::generic_category(), "no descriptor left for waiting");
  return FileDescriptor(descriptor);
}

/// Returns a descriptor that is readable when one of `descriptors` is.
FileDescriptor either(std::initializer_list<int> descriptors) {
  FileDescriptor both = checked(epoll_create1(EPOLL_CLOEXEC));
  for (const int descriptor : descriptors) {
    epoll_event event{};
    event.events = EPOLLIN;
    if (epoll_ctl(both.get(), EPOLL_CTL_ADD, descriptor, &event) != 0)
      throw std::system_error(errno, std::generic_category(), "cannot wait for signals");
  }
  return both;
}

}  // namespace

std::vector<std::string> with_own_nodes(
    const OwnNodes& own,
    const std::function<void(const std::string& socket, const std::stop_token& stop)>& job) {
  const Installation installation = this_installation();
  if (const std::string obstacle = obstacle_to_nodes(installation); !obstacle.empty())
    throw std::runtime_error(obstacle);
  SignalInbox inbox({SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGCHLD});
  const RunFolder folder;
  const std::string socket = folder.path() / "nodes.sock";
  NodeChoices choices = own.choices;
  choices.any_file = true;  // the only client is this command
  std::optional<NodeGroup> group;
  group.emplace(
      installation,
      NodeGroupPlan{.placement = own.placement, .socket = socket, .folder = folder.path(), .choices = choices});

  const FileDescriptor job_over = checked(eventfd(0, EFD_CLOEXEC));
  const FileDescriptor events = either({inbox.descriptor(), job_over.get()});
  std::exception_ptr trouble;
  bool interrupted = false;
  std::jthread thread([&](const std::stop_token& stop) {
    try {
      job(socket, stop);
    } catch (...) {
      trouble = std::current_exception();
    }
    constexpr std::uint64_t one = 1;
    // A write of one to an eventfd never blocks here.
    [[maybe_unused]] const ssize_t written = ::write(job_over.get(), &one, sizeof one);
  });
  const auto is_over = [&] { return compositor::wait_until_ready(job_over.get(), POLLIN, {}); };
  while (!is_over() && !interrupted) {
    while (const std::optional<ReceivedSignal> received = inbox.next()) {
      if (received->number == SIGCHLD)
        group->look_after_children();
      else
        interrupted = true;
    }
    if (!interrupted) group->wait_and_serve(events.get());
  }
  if (interrupted) {
    thread.request_stop();
    group.reset();
  }
  thread.join();
  if (interrupted) throw std::runtime_error("interrupted");
  if (trouble) std::rethrow_exception(trouble);
  group.reset();  // completes the nodes' log
  return backend_choices(folder.path());
}

}  // namespace understudy::launcher
