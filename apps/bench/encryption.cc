// SPDX-License-Identifier: Apache-2.0
// understudy-bench-encryption: measures the cost of encryption on a TCP connection between two threads of
// this program. Incompressible noise is sent from one to the other, with and without encryption in turns.
// Prints one JSON object for each turn: nanoseconds of processor time per byte at both ends, and the bytes
// per second of the connection.
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "compositor/service/service_protocols.h"
#include "compositor/transport/tcp/handshake.h"
#include "compositor/transport/tcp/tcp_connection.h"
#include "compositor/transport/tcp/tcp_socket.h"

namespace {

using namespace understudy::compositor;

constexpr std::size_t message_bytes = std::size_t(64) << 20;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

struct Ends {
  AuthenticatedSocket client;
  AuthenticatedSocket server;
};

Ends connected(bool plain) {
  const Deadline deadline = Clock::now() + std::chrono::seconds(10);
  const FileDescriptor listening = listen_at(TcpAddress{"127.0.0.1", 0});
  Ends ends{{connect_to(own_address(listening.get()), deadline), {}}, {}};
  if (!wait_until_ready(listening.get(), POLLIN, deadline)) throw std::runtime_error("no client connects");
  ends.server.socket =
      FileDescriptor(::accept4(listening.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  set_connection_options(ends.server.socket.get());
  const Credentials credentials{Secret(std::as_bytes(std::span("what both ends have")))};
  ConnectionRequest request;
  request.plain = plain;
  ClientHandshake client(credentials, request);
  ServerHandshake server(credentials);
  const std::span<const std::byte> hello = client.hello();
  server.answer(hello.first(hello_bytes));
  server.answer(client.answer(server.answer(hello.subspan(hello_bytes))));
  ends.client.keys = client.session_keys();
  ends.server.keys = server.session_keys();
  return ends;
}

nlohmann::json turn(bool plain, Bytes noise, int messages) {
  Ends ends = connected(plain);
  TcpConnection from(std::move(ends.client), service_protocols, message_bytes);
  TcpConnection to(std::move(ends.server), service_protocols, message_bytes);
  const auto begun = Clock::now();
  const double receiving_before = processor_seconds();
  double sending = 0;
  std::jthread sender([&] {
    const double before = processor_seconds();
    for (int i = 0; i < messages; ++i) from.send(NodeMessage::add_texels, 0, {&noise, 1});
    sending = processor_seconds() - before;
  });
  for (int i = 0; i < messages; ++i) to.receive();
  const double receiving = processor_seconds() - receiving_before;
  const double seconds = std::chrono::duration<double>(Clock::now() - begun).count();
  sender.join();
  const double bytes = double(messages) * double(noise.size());
  return {{"way", plain ? "plain" : "encrypted"},
          {"send_ns_per_byte", 1e9 * sending / bytes},
          {"receive_ns_per_byte", 1e9 * receiving / bytes},
          {"bytes_per_second", bytes / seconds}};
}

}  // namespace

int main(int argc, char** argv) {
  int turns = 5;
  int messages = 4;
  CLI::App app("Measures the cost of encryption on a connection over TCP.");
  app.set_help_flag("-h,--help", "print this help and exit");
  app.add_option("--turns", turns, "number of turns, encrypted and unencrypted")->capture_default_str();
  app.add_option("--messages", messages, "number of messages of 64 MiB in each turn")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::vector<std::byte> noise(message_bytes);
  std::generate(noise.begin(), noise.end(),
                [random = std::mt19937(1)]() mutable { return std::byte(random()); });
  for (int i = 0; i < turns; ++i)
    for (const bool plain : {true, false}) fmt::print("{}\n", turn(plain, noise, messages).dump());
}
