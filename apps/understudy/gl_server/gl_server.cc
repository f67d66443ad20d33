// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/gl_server/gl_server.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <vector>

#include "apps/understudy/gl_server/client_environment.h"
#include "apps/understudy/gl_server/client_process.h"
#include "apps/understudy/gl_server/frame_changes.h"
#include "apps/understudy/offscreen/offscreen_contexts.h"
#include "apps/understudy/sandbox/sandbox.h"
#include "compositor/logging/log.h"
#include "compositor/service/client_limits.h"
#include "compositor/service/limits.h"
#include "compositor/transport/connection.h"
#include "compositor/transport/connector.h"
#include "spu/chain_text.h"
#include "spu/options.h"
#include "spu/player/player.h"
#include "spu/registry/assemble.h"
#include "spu/remote/gl_server_protocol.h"
#include "spu/report/counters.h"
#include "spu/stream/call_answer.h"
#include "spu/stream/event.h"
#include "spu/tiles/tile.h"
#include "spu/tiles/tile_workers.h"
#include "spu/window_system/shown_image.h"

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

constexpr std::chrono::seconds patience_with_client{10};
/// Maximum number of distinct faults of a stream that are logged.
constexpr std::size_t most_faults_told = 20;

/// Returns the options of an application's GL server: its chain gets the socket of the GL
/// server that runs tile workers.
spu::Options options_of_application(const std::string& socket) {
  spu::Options options = spu::options_from_environment();
  options.chain = spu::resolved_chain(options.chain, std::filesystem::current_path());
  spu::ChainSettings chain = spu::parse_chain(options.chain);
  auto tiles = std::find_if(chain.begin(), chain.end(),
                            [](const spu::UnitSetting& unit) { return unit.name == "tiles"; });
  if (tiles == chain.end() && options.tiles) {
    const int parts = std::min(options.nodes, spu::most_tiles);
    if (parts < 2) {
      logging::log(logging::Level::warn,
                   "--tiles on has no effect with fewer than two nodes; give -n 2 or more");
      return options;
    }
    tiles = chain.insert(chain.end() - 1,
                         {.name = "tiles", .options = {{"of", std::to_string(parts), {}}}, .where = {}});
  }
  if (tiles == chain.end()) return options;
  tiles->options.push_back({"gl-server", socket, {}});
  options.chain = spu::chain_text(chain);
  return options;
}

/// Returns the options of a tile worker: all other units are in the chain of the application's GL server.
spu::Options options_of_tile_worker(const spu::TilePlace& place) {
  spu::Options options = spu::options_from_environment();
  options.chain = fmt::format("tile(part={},of={}) driver", place.part, place.parts);
  options.save_frames.clear();
  options.export_folder.clear();
  return options;
}

/// Returns the folders that the options write to, and those of libraries: of the
/// installation and of the environment.
SandboxFolders folders_used(const spu::Options& options) {
  SandboxFolders folders;
  if (!options.save_frames.empty()) folders.written.emplace_back(options.save_frames);
  if (!options.export_folder.empty()) folders.written.emplace_back(options.export_folder);
  for (const std::filesystem::path& file : spu::files_of_units(options.chain))
    folders.written.push_back(file.parent_path());
  folders.libraries = folders_of_libraries(current_environment());
  folders.libraries.push_back(this_installation().libraries);
  return folders;
}

/// Draws once with a temporary context, so that the driver creates its threads and opens its files. Throws
/// std::runtime_error if that fails.
Renderer draw_once(OffscreenContexts& windows, const spu::GlServerVersions& versions) {
  constexpr spu::Extent2D small{16, 16};
  spu::RecordedContext context;
  context.number = ~std::uint64_t(0);  // applications number their contexts from 1
  context.version = versions.compatibility > 0 ? versions.compatibility : versions.core;
  if (versions.compatibility == 0) context.profile = GL_CONTEXT_CORE_PROFILE_BIT;
  windows.create(context);
  windows.make_current(context.number, 0, small);
  const spu::DispatchTable& gl = windows.driver();
  gl.Clear(GL_COLOR_BUFFER_BIT);
  std::array<std::uint8_t, std::size_t(4) * small.width * small.height> pixels{};
  gl.ReadPixels(0, 0, small.width, small.height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  const auto* const text = reinterpret_cast<const char*>(gl.GetString(GL_RENDERER));
  const Renderer renderer = renderer_named(text != nullptr ? text : "");
  windows.release_current();
  windows.destroy(context.number);
  return renderer;
}

/// Executes the calls of one application as they arrive; or, as a tile worker, the calls of
/// an application's GL server.
class Performance {
 public:
  Performance(Connection& connection, const spu::Options& options, bool paints, const Sandbox* sandbox)
      : connection_(connection),
        paints_(paints),
        sandbox_(sandbox),
        embedded_(options.connect.empty()),
        windows_(open_offscreen_contexts(options.server_opengl)),
        player_(*windows_, options, paints ? spu::StreamOrigin::elsewhere : spu::StreamOrigin::linked) {
    player_.on_frame = [this](const spu::ShownFrame& frame) {
      if (paints_) return show_tile();
      show(frame);
    };
  }

  /// Returns when the application closes the connection. Throws std::runtime_error if the stream is malformed.
  void run() {
    const spu::GlServerVersions versions{windows_->highest_version(true), windows_->highest_version(false)};
    if (sandbox_ != nullptr) close_sandbox(versions);
    connection_.send(compositor::LauncherMessage::accepted, 0, spu::encode(versions),
                     Clock::now() + limits::server_patience);
    for (;;) {
      std::optional<Message> message;
      try {
        message = next();
      } catch (const compositor::ConnectionLost&) {
        return;
      }
      if (message->type != spu::GlServerMessage::calls) throw MalformedMessage("sent an unexpected message");
      play(spu::decode_calls(message->payload, chunks_));
    }
  }

 private:
  /// Closes the sandbox, after everything that opens files on first use has been used; from then on,
  /// opening files is refused.
  void close_sandbox(const spu::GlServerVersions& versions) {
    compositor::usable_memory();
    // TBB's first use opens its allocator and reads the number of processors.
    if (embedded_) tbb::parallel_for(0, 64, [](int) {});
    Renderer renderer = Renderer::cpu;
    try {
      renderer = draw_once(*windows_, versions);
    } catch (const std::runtime_error&) {
      // The application gets this error when it creates a context.
    }
    const SandboxState state = sandbox_->close(renderer);
    if (!state.obstacle.empty())
      logging::log(logging::Level::warn, "GL server: calls are executed without a sandbox: {}", state.obstacle);
    else if (!state.no_landlock.empty() && (renderer == Renderer::graphics_card || sandbox_->writes()))
      logging::log(logging::Level::warn,
                   "GL server: files cannot be written, and the driver of a graphics card cannot open files: "
                   "{}; --sandbox off disables the sandbox",
                   state.no_landlock);
  }

  /// An application may be silent between messages for any time, but not within a message.
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
    tile_.clear();
    if (paints_ && calls.head.reply == spu::ServerReply::answer) forget_errors();
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
    if (calls.head.reply == spu::ServerReply::answer) {
      const spu::CallAnswer nothing;
      const spu::CallAnswer answer = !played ? nothing : paints_ ? painted() : player_.call_answer();
      reply(spu::GlServerMessage::answered, spu::encode(answer), {});
    } else if (calls.head.reply == spu::ServerReply::image) {
      const spu::ImageChange change = shown_.value_or(spu::ImageChange{});
      reply(spu::GlServerMessage::image, spu::encode_head(change), change.pixels);
    }
  }

  void reply(MessageType type, const std::vector<std::byte>& head, Bytes pixels) {
    const std::array<Bytes, 2> parts = {head, pixels};
    connection_.send(type, 0, parts, limits::server_patience);
  }

  void show(const spu::ShownFrame& frame) {
    const spu::Extent2D extent = player_.current().drawable;
    if (frame.extent.width == 0 || frame.extent.height == 0) return;
    shown_ = changes_.next(player_.drawable(), extent, player_.shown_image());
  }

  // For a tile worker, which has to return pixels only.

  void show_tile() {
    const spu::Tile& tile = *spu::Chain::current()->find<spu::Tile>();
    const spu::Rows rows = tile.rows();
    tile_ = spu::shown_rows(player_.driver(), tile.extent().width, rows.first, rows.count);
  }

  void forget_errors() {
    if (!player_.prepare()) return;
    // A lost context returns an error forever, so the loop is bounded.
    for (int i = 0; i < 16 && player_.driver().GetError() != GL_NO_ERROR; ++i) continue;
  }

  /// Returns the pixels; nothing if OpenGL failed to read them.
  spu::CallAnswer painted() {
    spu::CallAnswer answer;
    const spu::Decoder::ReadImage& read = player_.read_image();
    if (!tile_.empty()) {
      const auto bytes = std::as_bytes(std::span(tile_));
      answer.outputs.push_back({.bytes = {bytes.begin(), bytes.end()}});
    } else if (!read.pixels.empty() && player_.driver().GetError() == GL_NO_ERROR) {
      answer.outputs.push_back({.image = read.shape, .bytes = read.pixels});
    }
    return answer;
  }

  void tell(const std::string& fault) {
    if (told_.size() < most_faults_told && told_.insert(fault).second)
      logging::log(logging::Level::warn, "GL server: {}; the call is skipped", fault);
  }

  Connection& connection_;
  const bool paints_;
  const Sandbox* const sandbox_;  ///< null: no sandbox was requested
  const bool embedded_;           ///< rays are cast in this process
  const std::unique_ptr<OffscreenContexts> windows_;
  spu::Player player_;
  spu::ChunkReceiver chunks_;
  FrameChanges changes_;
  std::optional<spu::ImageChange> shown_;
  std::vector<std::uint8_t> tile_;
  std::set<std::string> told_;
};

/// Serves one application, or another GL server as its tile worker, in a separate
/// process. Returns its exit status.
int perform(FileDescriptor socket, const std::string& address) {
  FileDescriptor same(::fcntl(socket.get(), F_DUPFD_CLOEXEC, 0));
  try {
    // Until the client has identified itself, only short messages are read.
    Connection pending(std::move(socket), spu::gl_server_protocols, limits::max_hello_bytes);
    const Message hello = pending.receive(Clock::now() + limits::hello_patience);
    if (hello.type != compositor::LauncherMessage::hello_client)
      throw MalformedMessage("the first message is not a hello");
    Connection connection(std::move(same), spu::gl_server_protocols, limits::max_gl_server_message_bytes);
    try {
      const bool paints = !hello.payload.empty();
      // Frames that a tile worker draws a part of are counted by the application's GL server.
      if (paints) ::unsetenv("UNDERSTUDY_RUN_DIR");
      const spu::Options options = paints ? options_of_tile_worker(spu::decode_tile_place(hello.payload))
                                          : options_of_application(address);
      spu::process_counters();  // creates a file, if a folder is set
      std::optional<Sandbox> sandbox;
      if (options.sandbox) sandbox.emplace(folders_used(options));
      Performance(connection, options, paints, sandbox ? &*sandbox : nullptr).run();
    } catch (const compositor::ConnectionLost&) {
      throw;
    } catch (const std::exception& error) {
      connection.send(compositor::LauncherMessage::refused, 0, compositor::encode_text(error.what()),
                      Connection::now_or_never());
      throw;
    }
  } catch (const std::exception& error) {
    logging::log(logging::Level::warn, "GL server: dropped an application: {}", error.what());
    return 1;
  }
  return 0;
}

/// Exits without running destructors: what drivers do at exit is not needed, and may open files.
[[noreturn]] void serve_one(const std::string& socket, int client, int connector) {
  for (const int descriptor : {client, connector}) ::fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  compositor::connect_through(FileDescriptor(connector));
  const int status = perform(FileDescriptor(client), socket);
  std::fflush(nullptr);
  ::_exit(status);
}

}  // namespace

std::unique_ptr<ChildProcess> start_gl_server(const Installation& installation,
                                              const std::filesystem::path& socket, Environment environment) {
  // Ctrl-C in the terminal is the viewer's: one that handles it needs its OpenGL afterwards.
  auto server = std::make_unique<ChildProcess>(
      Command{.arguments = {installation.programs / "understudy", "gl-server", "--socket", socket},
              .environment = std::move(environment),
              .own_group = true});
  const auto until = Clock::now() + patience_with_client;
  std::error_code unreadable;
  while (!std::filesystem::is_socket(socket, unreadable)) {
    if (const auto ending = server->wait_for_ending(5))
      throw std::runtime_error(fmt::format("the GL server {}", ending->text()));
    if (Clock::now() > until)
      throw std::runtime_error(fmt::format("the GL server does not listen at {}", socket.string()));
  }
  return server;
}

void add_gl_server_command(CLI::App& app, std::function<int()>& chosen) {
  struct Arguments {
    std::string socket;
    int client = -1;     ///< descriptor of the connection to serve; -1: this process listens
    int connector = -1;  ///< descriptor of the channel to the listening process
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* subcommand =
      app.add_subcommand("gl-server", "executes the OpenGL calls of viewers, for run --remote");
  subcommand->group("");
  subcommand->add_option("--socket", arguments->socket)->required();
  subcommand->add_option("--connector", arguments->connector)
      ->needs(subcommand->add_option("--client", arguments->client));
  subcommand->callback([arguments, &chosen] {
    chosen = [arguments] {
      if (arguments->client >= 0) serve_one(arguments->socket, arguments->client, arguments->connector);
      serve_clients(arguments->socket);
      return 0;
    };
  });
}

}  // namespace understudy::launcher
