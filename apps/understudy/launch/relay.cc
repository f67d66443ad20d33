// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/relay.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <thread>

#include "apps/understudy/launch/connection_figures.h"
#include "apps/understudy/launch/run_folder.h"
#include "apps/understudy/processes/client_processes.h"
#include "apps/understudy/processes/environment.h"
#include "apps/understudy/processes/signal_inbox.h"
#include "compositor/exchange/settings.h"
#include "compositor/logging/log.h"
#include "compositor/relay/render_relay.h"
#include "compositor/service/limits.h"
#include "compositor/service/service_protocols.h"
#include "compositor/transport/tcp/key_file.h"
#include "compositor/transport/tcp/tcp_connection.h"
#include "spu/remote/gl_server_relay.h"

namespace understudy::launcher {
namespace {

using compositor::Clock;
using compositor::Connection;
using compositor::Destination;
using compositor::FileDescriptor;
using compositor::TcpConnection;
namespace limits = compositor::limits;

constexpr std::chrono::seconds patience_with_relay{10};
constexpr std::array<const char*, 3> layout_names = {"float", "half", "byte"};

compositor::Credentials credentials_of(const ConnectionPlan& plan) {
  if (plan.key_file.empty()) return compositor::Credentials(compositor::read_secret(plan.secret_file));
  const std::vector<compositor::PublicKey> server = compositor::read_public_keys(plan.server_key);
  if (server.size() != 1)
    throw std::runtime_error(fmt::format("'{}' holds {} public keys; --server-key takes the key of one server",
                                         plan.server_key.string(), server.size()));
  return {compositor::read_key_file(plan.key_file), server};
}

compositor::AuthenticatedSocket linked(const ConnectionPlan& plan) {
  const auto address = compositor::tcp_address_of(plan.address);
  if (!address) throw std::runtime_error(fmt::format("'{}' is not a HOST:PORT", plan.address));
  return compositor::connect_tcp(*address, credentials_of(plan), plan.connection_request,
                                 Clock::now() + limits::hello_patience);
}

/// Shuts down both connections when a signal requests the end, so that the relay returns and can write its
/// figures. To be constructed before other threads exist.
class EndWhenAsked {
 public:
  EndWhenAsked(int here, int connection)
      : thread_([this, here, connection](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            if (!compositor::wait_until_ready(inbox_.descriptor(), POLLIN, Clock::now() + look_every)) continue;
            ::shutdown(here, SHUT_RDWR);
            ::shutdown(connection, SHUT_RDWR);
            return;
          }
        }) {}

 private:
  static constexpr std::chrono::milliseconds look_every{100};
  SignalInbox inbox_{{SIGTERM, SIGINT, SIGHUP}};
  std::jthread thread_;
};

/// Relays the messages of one local application, in a process of its own. Returns its exit status.
int carry(FileDescriptor application, const ConnectionPlan& plan, const std::filesystem::path& figures) {
  const bool to_server = plan.connection_request.to == Destination::gl_server;
  const std::uint64_t most = to_server ? limits::max_gl_server_message_bytes : limits::max_message_bytes;
  const compositor::Protocols spoken = to_server ? compositor::Protocols(spu::gl_server_protocols)
                                                 : compositor::Protocols(compositor::service_protocols);
  Connection here(std::move(application), spoken, most);
  try {
    TcpConnection connection(linked(plan), spoken, to_server ? most : limits::max_image_message_bytes);
    const EndWhenAsked end_when_asked(here.fd(), connection.fd());
    std::string why;
    if (to_server)
      why = spu::ViewerRelay(here, connection).run();
    else
      why = compositor::ApplicationRelay(here, connection).run();
    write_connection_figures(figures, plan.address, connection);
    if (!why.empty()) logging::log(logging::Level::warn, "the connection to {}: {}", plan.address, why);
    return why.empty() ? 0 : 1;
  } catch (const std::exception& error) {
    // The application reports the error where it reports its own.
    here.send(compositor::LauncherMessage::refused, 0, compositor::encode_text(error.what()),
              Connection::now_or_never());
  }
  return 1;
}

}  // namespace

std::string lack_of_credentials(const std::string& address) {
  return fmt::format(
      "--connect {0} needs --secret-file FILE, the secret file of understudy serve --listen {0}, copied to "
      "this machine; or --key and --server-key",
      address);
}

void try_connection(const ConnectionPlan& plan) {
  ConnectionPlan asking = plan;
  asking.connection_request.only_asks = true;
  linked(asking);
}

std::unique_ptr<ChildProcess> start_relay(const Installation& installation, const ConnectionPlan& plan,
                                          const std::filesystem::path& socket,
                                          const std::filesystem::path& folder) {
  std::vector<std::string> words = {
      installation.programs / "understudy",
      "relay",
      "--connect",
      plan.address,
      "--to",
      plan.connection_request.to == Destination::gl_server ? "gl-server" : "nodes",
      "--pixels",
      layout_names[std::size_t(plan.connection_request.pixels)],
      "--quality",
      std::to_string(plan.connection_request.jpeg_quality),
      "--socket",
      socket,
      "--figures",
      folder};
  const auto add_file = [&](const char* option, const std::filesystem::path& file) {
    if (!file.empty()) words.insert(words.end(), {option, std::filesystem::absolute(file)});
  };
  add_file("--secret-file", plan.secret_file);
  add_file("--key", plan.key_file);
  add_file("--server-key", plan.server_key);
  if (plan.connection_request.plain) words.emplace_back("--plain");
  auto relay = std::make_unique<ChildProcess>(
      Command{.arguments = words, .environment = current_environment(), .own_group = true});
  const auto until = Clock::now() + patience_with_relay;
  std::error_code unreadable;
  while (!std::filesystem::is_socket(socket, unreadable)) {
    if (const auto ending = relay->wait_for_ending(5))
      throw std::runtime_error(fmt::format("the relay for {} {}", plan.address, ending->text()));
    if (Clock::now() > until)
      throw std::runtime_error(
          fmt::format("the relay for {} does not listen at {}", plan.address, socket.string()));
  }
  return relay;
}

void with_connection(ConnectionPlan plan, const std::string& address, const std::string& pixels,
                     const std::function<void(const std::string& socket)>& job) {
  if (!plan.has_credentials()) throw std::runtime_error(lack_of_credentials(address));
  plan.address = address;
  compositor::ExchangeSettings settings;
  compositor::set_layout(settings, pixels);
  plan.connection_request.pixels = settings.layout;
  try_connection(plan);
  const RunFolder folder;
  const std::filesystem::path socket = folder.path() / "link.sock";
  const std::unique_ptr<ChildProcess> relay = start_relay(this_installation(), plan, socket, folder.path());
  job(socket);
}

void add_connection_options(CLI::App& subcommand, ConnectionPlan& plan) {
  CLI::Option* secret =
      subcommand
          .add_option(
              "--secret-file", plan.secret_file,
              "with --connect HOST:PORT: secret file of the `understudy serve` there, copied to this machine")
          ->type_name("FILE");
  CLI::Option* key =
      subcommand
          .add_option("--key", plan.key_file,
                      "with --connect HOST:PORT, instead of --secret-file: key of this client (understudy key "
                      "FILE), whose public key must be in the file of `understudy serve --clients` there")
          ->type_name("FILE")
          ->excludes(secret);
  CLI::Option* server_key =
      subcommand
          .add_option("--server-key", plan.server_key, "with --key: file of the server's public key (FILE.pub)")
          ->type_name("FILE.pub")
          ->needs(key);
  key->needs(server_key);
  subcommand
      .add_option("--quality", plan.connection_request.jpeg_quality,
                  "with --connect HOST:PORT: JPEG quality of images while the view moves; images of a view at "
                  "rest are lossless; default: all images are lossless")
      ->type_name("1..100")
      ->check(CLI::Range(1, 100));
  subcommand.add_flag("--plain", plan.connection_request.plain,
                      "with --connect to this machine (for example through ssh): do not encrypt the "
                      "connection; `understudy serve` needs --plain as well");
}

void add_relay(CLI::App& app, std::function<int()>& chosen) {
  struct Arguments {
    ConnectionPlan plan;
    std::string socket;
    std::filesystem::path figures;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* subcommand =
      app.add_subcommand("relay", "relays messages to another machine, for --connect HOST:PORT");
  subcommand->group("");
  subcommand->add_option("--connect", arguments->plan.address)->required();
  subcommand->add_option("--secret-file", arguments->plan.secret_file);
  subcommand->add_option("--key", arguments->plan.key_file);
  subcommand->add_option("--server-key", arguments->plan.server_key);
  const std::map<std::string, Destination> services = {{"nodes", Destination::nodes},
                                                       {"gl-server", Destination::gl_server}};
  subcommand->add_option("--to", arguments->plan.connection_request.to)
      ->required()
      ->transform(CLI::CheckedTransformer(services));
  std::map<std::string, compositor::Layout> layouts;
  for (std::size_t i = 0; i < layout_names.size(); ++i) layouts[layout_names[i]] = compositor::Layout(i);
  subcommand->add_option("--pixels", arguments->plan.connection_request.pixels)
      ->transform(CLI::CheckedTransformer(layouts));
  subcommand->add_option("--quality", arguments->plan.connection_request.jpeg_quality);
  subcommand->add_flag("--plain", arguments->plan.connection_request.plain);
  subcommand->add_option("--socket", arguments->socket)->required();
  subcommand->add_option("--figures", arguments->figures)->required();
  subcommand->callback([arguments, &chosen] {
    chosen = [arguments] {
      listen_for_clients(arguments->socket, "relay", [&](FileDescriptor application) {
        return carry(std::move(application), arguments->plan, arguments->figures);
      });
      return 0;
    };
  });
}

}  // namespace understudy::launcher
