#include "apps/understudy/stage.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>

#include "apps/understudy/client_processes.h"
#include "apps/understudy/frame_changes.h"
#include "apps/understudy/offscreen_contexts.h"
#include "apps/understudy/signal_inbox.h"
#include "compositor/service/connection.h"
#include "compositor/service/limits.h"
#include "spu/link/stage_protocol.h"
#include "spu/options.h"
#include "spu/player/player.h"
#include "spu/player/shown_picture.h"
#include "spu/report/counters.h"
#include "spu/stream/call_answer.h"
#include "spu/stream/event.h"

namespace understudy::launcher {
namespace {

using compositor::Bytes;
using compositor::Clock;
using compositor::Connection;
using compositor::FileDescriptor;
using compositor::MalformedMessage;
using compositor::Message;
using compositor::MessageType;
namespace limits = compositor::limits;

constexpr std::chrono::seconds patience_with_start{10};
/// Different faults of a stream that are said.
constexpr std::size_t most_faults_told = 20;

/// One application's calls, played as they come.
class Performance {
 public:
  Performance(Connection& connection, const spu::Options& options)
      : connection_(connection),
        windows_(open_offscreen_contexts(options.stage_opengl)),
        player_(*windows_, options, spu::StreamOrigin::linked) {
    player_.on_frame = [this](const spu::ShownFrame& frame) { show(frame); };
  }

  /// Returns when the application closes the connection. Throws std::runtime_error for what is no stream.
  void run() {
    const spu::StageVersions versions{windows_->highest_version(true), windows_->highest_version(false)};
    connection_.send(MessageType::welcome, 0, spu::encode(versions), Clock::now() + limits::stage_patience);
    for (;;) {
      std::optional<Message> message;
      try {
        message = next();
      } catch (const compositor::ConnectionLost&) {
        return;
      }
      if (message->type != MessageType::calls) throw MalformedMessage("spoke out of turn");
      play(spu::decode_calls(message->payload, chunks_));
    }
  }

 private:
  /// An application may be silent for as long as nobody touches it, but not within a message.
  Message next() {
    for (;;) {
      if (std::optional<Message> message = connection_.receive_some()) return std::move(*message);
      const auto until = connection_.unfinished() ? Clock::now() + limits::stall_patience
                                                  : Clock::now() + std::chrono::hours(24);
      if (!compositor::wait_until_ready(connection_.fd(), POLLIN, until) && connection_.unfinished())
        throw compositor::ConnectionLost("stalled");
    }
  }

  void play(const spu::Calls& calls) {
    shown_.reset();
    const std::array<std::uint64_t, 2> thread = {spu::event::thread | std::uint64_t(2) << 32,
                                                 calls.head.thread};
    player_.play({spu::event::thread, thread, {}});
    std::uint64_t& counted = *spu::thread_call_counter();
    bool played = true;
    for (std::size_t position = 0; position < calls.records.size();) {
      const auto record = spu::record_at(calls.records, position, calls.payload);
      if (!record) throw MalformedMessage("a record is longer than its message");
      position += record->words.size();
      const std::string error = player_.play(*record);
      if (spu::event::name_of(record->id) == nullptr) ++counted;
      played = error.empty();
      if (!played) tell(error);
    }
    if (calls.head.reply == spu::StageReply::answer) {
      const spu::CallAnswer nothing;
      reply(MessageType::answered, spu::encode(played ? player_.call_answer() : nothing), {});
    } else if (calls.head.reply == spu::StageReply::picture) {
      const spu::PictureChange change = shown_.value_or(spu::PictureChange{});
      reply(MessageType::picture, spu::encode_head(change), change.pixels);
    }
  }

  void reply(MessageType type, const std::vector<std::byte>& head, Bytes pixels) {
    const std::array<Bytes, 2> parts = {head, pixels};
    connection_.send(type, 0, parts, limits::stage_patience);
  }

  void show(const spu::ShownFrame& frame) {
    const spu::Extent2D extent = player_.current().drawable;
    if (frame.extent.width == 0 || frame.extent.height == 0) return;
    shown_ = changes_.next(player_.drawable(), extent, spu::shown_picture(player_.driver(), extent));
  }

  void tell(const std::string& fault) {
    if (told_.size() < most_faults_told && told_.insert(fault).second)
      fmt::print(stderr, "understudy: stage: {}; the call is left out\n", fault);
  }

  Connection& connection_;
  const std::unique_ptr<OffscreenContexts> windows_;
  spu::Player player_;
  spu::ChunkReceiver chunks_;
  FrameChanges changes_;
  std::optional<spu::PictureChange> shown_;
  std::set<std::string> told_;
};

/// What a process of its own does for one application. Returns its exit status.
int perform(FileDescriptor socket) {
  FileDescriptor same(::dup(socket.get()));
  try {
    // Nothing long is read from whoever has not said what it is.
    Connection stranger(std::move(socket), limits::max_hello_bytes);
    const Message hello = stranger.receive(Clock::now() + limits::hello_patience);
    if (hello.type != MessageType::hello_client) throw MalformedMessage("its first message is no hello");
    Connection connection(std::move(same), limits::max_stage_message_bytes);
    try {
      Performance(connection, spu::options_from_environment()).run();
    } catch (const compositor::ConnectionLost&) {
      throw;
    } catch (const std::exception& error) {
      connection.send(MessageType::refused, 0, compositor::encode_text(error.what()),
                      Connection::now_or_never());
      throw;
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "understudy: stage: dropped an application: {}\n", error.what());
    return 1;
  }
  return 0;
}

}  // namespace

std::unique_ptr<ChildProcess> start_stage(const Installation& installation, const std::filesystem::path& socket,
                                          Environment environment) {
  auto stage = std::make_unique<ChildProcess>(
      Command{.arguments = {installation.programs / "understudy", "stage", "--socket", socket},
              .environment = std::move(environment)});
  const auto until = Clock::now() + patience_with_start;
  std::error_code unreadable;
  while (!std::filesystem::is_socket(socket, unreadable)) {
    if (const auto ending = stage->wait_for_ending(5))
      throw std::runtime_error(fmt::format("the stage {}", ending->text()));
    if (Clock::now() > until)
      throw std::runtime_error(fmt::format("the stage does not listen at {}", socket.string()));
  }
  return stage;
}

void add_stage(CLI::App& app, std::function<int()>& chosen) {
  const auto socket = std::make_shared<std::string>();
  CLI::App* subcommand = app.add_subcommand("stage", "makes the calls of viewers, for run --remote");
  subcommand->group("");
  subcommand->add_option("--socket", *socket)->required();
  subcommand->callback([socket, &chosen] {
    chosen = [socket] {
      listen_for_clients(*socket, "stage", perform);
      return 0;
    };
  });
}

}  // namespace understudy::launcher
