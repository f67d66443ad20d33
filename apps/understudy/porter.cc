#include "apps/understudy/porter.h"

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

#include "apps/understudy/client_processes.h"
#include "apps/understudy/environment.h"
#include "apps/understudy/link_figures.h"
#include "apps/understudy/run_folder.h"
#include "apps/understudy/signal_inbox.h"
#include "compositor/service/limits.h"
#include "compositor/tcp/render_porter.h"
#include "compositor/tcp/tcp_link.h"
#include "spu/link/stage_porter.h"

namespace understudy::launcher {
namespace {

using compositor::Clock;
using compositor::Connection;
using compositor::FileDescriptor;
using compositor::LinkedTo;
using compositor::LinkWishes;
using compositor::TcpLink;
namespace limits = compositor::limits;

constexpr std::chrono::seconds patience_with_start{10};
constexpr std::array<const char*, 3> layout_names = {"float", "half", "byte"};

FileDescriptor linked(const LinkPlan& plan) {
  const auto address = compositor::tcp_address_of(plan.address);
  if (!address) throw std::runtime_error(fmt::format("'{}' is no host:port", plan.address));
  const compositor::Secret secret = compositor::read_secret(plan.secret_file);
  return compositor::connect_link(*address, secret, plan.wishes, Clock::now() + limits::hello_patience);
}

/// Ends both connections when a signal asks for the end, so that who carries between them comes to an end and
/// can say what it has done. To be made before there are other threads.
class EndWhenAsked {
 public:
  EndWhenAsked(int here, int link)
      : thread_([this, here, link](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            if (!compositor::wait_until_ready(inbox_.descriptor(), POLLIN, Clock::now() + look_every)) continue;
            ::shutdown(here, SHUT_RDWR);
            ::shutdown(link, SHUT_RDWR);
            return;
          }
        }) {}

 private:
  static constexpr std::chrono::milliseconds look_every{100};
  SignalInbox inbox_{{SIGTERM, SIGINT, SIGHUP}};
  std::jthread thread_;
};

/// What the process of one application here does. Returns its exit status.
int carry(FileDescriptor application, const LinkPlan& plan, const std::filesystem::path& figures) {
  const bool to_stage = plan.wishes.to == LinkedTo::stage;
  const std::uint64_t most = to_stage ? limits::max_stage_message_bytes : limits::max_message_bytes;
  Connection here(std::move(application), most);
  try {
    TcpLink link(linked(plan), to_stage ? most : limits::max_picture_message_bytes);
    const EndWhenAsked end_when_asked(here.fd(), link.fd());
    std::string why;
    if (to_stage)
      why = spu::ViewerPorter(here, link).run();
    else
      why = compositor::ApplicationPorter(here, link).run();
    write_link_figures(figures, plan.address, link);
    if (!why.empty()) fmt::print(stderr, "understudy: the link to {}: {}\n", plan.address, why);
    return why.empty() ? 0 : 1;
  } catch (const std::exception& error) {
    // The application says it where it says such things.
    here.send(compositor::MessageType::refused, 0, compositor::encode_text(error.what()),
              Connection::now_or_never());
  }
  return 1;
}

}  // namespace

void try_link(const LinkPlan& plan) {
  LinkPlan asking = plan;
  asking.wishes.only_asks = true;
  linked(asking);
}

std::unique_ptr<ChildProcess> start_porter(const Installation& installation, const LinkPlan& plan,
                                           const std::filesystem::path& socket,
                                           const std::filesystem::path& folder) {
  auto porter = std::make_unique<ChildProcess>(
      Command{.arguments = {installation.programs / "understudy", "porter", "--connect", plan.address,
                            "--secret-file", std::filesystem::absolute(plan.secret_file), "--to",
                            plan.wishes.to == LinkedTo::stage ? "stage" : "nodes", "--pixels",
                            layout_names[std::size_t(plan.wishes.pixels)], "--quality",
                            std::to_string(plan.wishes.jpeg_quality), "--socket", socket, "--figures", folder},
              .environment = current_environment(),
              .own_group = true});
  const auto until = Clock::now() + patience_with_start;
  std::error_code unreadable;
  while (!std::filesystem::is_socket(socket, unreadable)) {
    if (const auto ending = porter->wait_for_ending(5))
      throw std::runtime_error(fmt::format("the porter for {} {}", plan.address, ending->text()));
    if (Clock::now() > until)
      throw std::runtime_error(
          fmt::format("the porter for {} does not listen at {}", plan.address, socket.string()));
  }
  return porter;
}

void with_link(LinkPlan plan, const std::string& address, const std::string& pixels,
               const std::function<void(const std::string& socket)>& job) {
  if (plan.secret_file.empty())
    throw std::runtime_error(
        fmt::format("--connect {0} needs --secret-file FILE: the one that understudy serve --listen "
                    "{0} uses, copied to this machine",
                    address));
  plan.address = address;
  compositor::ExchangeSettings settings;
  compositor::set_layout(settings, pixels);
  plan.wishes.pixels = settings.layout;
  try_link(plan);
  const RunFolder folder;
  const std::filesystem::path socket = folder.path() / "link.sock";
  const std::unique_ptr<ChildProcess> porter = start_porter(this_installation(), plan, socket, folder.path());
  job(socket);
}

void add_link_options(CLI::App& subcommand, LinkPlan& plan) {
  subcommand
      .add_option("--secret-file", plan.secret_file,
                  "for --connect HOST:PORT: the secret of `understudy serve` there, copied to this machine")
      ->type_name("FILE");
  subcommand
      .add_option("--quality", plan.wishes.jpeg_quality,
                  "for --connect HOST:PORT: pictures of a view that moves come as JPEG of this quality, and as "
                  "they are "
                  "once it rests; without: always as they are")
      ->type_name("1..100")
      ->check(CLI::Range(1, 100));
}

void add_porter(CLI::App& app, std::function<int()>& chosen) {
  struct Arguments {
    LinkPlan plan;
    std::string socket;
    std::filesystem::path figures;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* subcommand =
      app.add_subcommand("porter", "carries messages to another machine, for --connect HOST:PORT");
  subcommand->group("");
  subcommand->add_option("--connect", arguments->plan.address)->required();
  subcommand->add_option("--secret-file", arguments->plan.secret_file)->required();
  const std::map<std::string, LinkedTo> services = {{"nodes", LinkedTo::nodes}, {"stage", LinkedTo::stage}};
  subcommand->add_option("--to", arguments->plan.wishes.to)
      ->required()
      ->transform(CLI::CheckedTransformer(services));
  std::map<std::string, compositor::Layout> layouts;
  for (std::size_t i = 0; i < layout_names.size(); ++i) layouts[layout_names[i]] = compositor::Layout(i);
  subcommand->add_option("--pixels", arguments->plan.wishes.pixels)
      ->transform(CLI::CheckedTransformer(layouts));
  subcommand->add_option("--quality", arguments->plan.wishes.jpeg_quality);
  subcommand->add_option("--socket", arguments->socket)->required();
  subcommand->add_option("--figures", arguments->figures)->required();
  subcommand->callback([arguments, &chosen] {
    chosen = [arguments] {
      listen_for_clients(arguments->socket, "porter", [&](FileDescriptor application) {
        return carry(std::move(application), arguments->plan, arguments->figures);
      });
      return 0;
    };
  });
}

}  // namespace understudy::launcher
