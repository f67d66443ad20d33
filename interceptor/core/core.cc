// SPDX-License-Identifier: Apache-2.0
// The core: one SPU chain for every desktop OpenGL context of the application.
#include "interceptor/core.h"

#include <cxxabi.h>
#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>

#include "compositor/logging/log.h"
#include "interceptor/core/redraw_request.h"
#include "interceptor/core/viewer_control.h"
#include "spu/chain.h"
#include "spu/lost_context.h"
#include "spu/options.h"
#include "spu/registry/assemble.h"
#include "spu/remote/front_end.h"
#include "spu/remote/remote.h"
#include "spu/remote/server_connection.h"
#include "spu/report/counters.h"
#include "spu/report/report.h"
#include "spu/track/share_group.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/volume_unit.h"

namespace understudy::interceptor {
namespace {

/// The entry library as the local window system, used when a GL server makes the calls.
class EntryFrontEnd final : public spu::FrontEnd {
 public:
  explicit EntryFrontEnd(const EntryServices& entry) : entry_(entry) {}

  spu::RecordedContext context() override {
    RemoteContextFormat format;
    entry_.remote_context_format(&format);
    return {.version = format.version,
            .profile = format.profile,
            .alpha = format.alpha,
            .depth = format.depth,
            .stencil = format.stencil,
            .samples = format.samples,
            .double_buffered = format.double_buffered != 0};
  }
  spu::FrontDrawable drawable() override {
    RemoteDrawable drawable;
    entry_.remote_drawable(&drawable);
    return {drawable.number, {drawable.width, drawable.height}, drawable.display};
  }
  void show(const spu::FrontDrawable& drawable, spu::Extent2D extent,
            std::span<const std::uint8_t> pixels) override {
    const RemoteDrawable where{drawable.number, drawable.extent.width, drawable.extent.height, drawable.screen};
    const RemoteImage image{extent.width, extent.height, pixels.data()};
    entry_.remote_show(&where, &image);
  }

 private:
  const EntryServices entry_;
};

class Core {
 public:
  Core(const EntryServices& entry, spu::Options options)
      : entry_(entry),
        options_(options),
        front_(entry),
        session_(std::make_shared<spu::RenderSession>(std::move(options))) {
    if (!options_.remote.empty()) server_ = std::make_unique<spu::ServerConnection>(options_.remote, front_);
    if (options_.frame_latency > 0)
      redraw_.emplace([session = session_.get()](std::uintptr_t window) {
        session->windows().asked(window);
        spu::process_counters().windows_asked.fetch_add(1, std::memory_order_relaxed);
      });
  }

  const EntryServices& entry() const { return entry_; }

  /// Sends the thread's calls to the driver; with a GL server, they do nothing from now on.
  void leave_to_driver() noexcept {
    ThreadState& thread = *entry_.thread_state();
    thread.table = server_ ? &spu::lost_context() : thread.driver;
  }

  RemoteVersions remote_versions() const {
    if (!server_) return {};
    return {server_->versions().core, server_->versions().compatibility};
  }

  void context_current(std::uintptr_t context, std::uintptr_t share, WindowSystem system, bool desktop_gl,
                       std::uintptr_t drawable) {
    ThreadState& thread = *entry_.thread_state();
    thread.calls = spu::thread_call_counter();
    // OSMesa draws into memory of this process, which a GL server cannot reach.
    if (!desktop_gl || (server_ && system == WindowSystem::osmesa)) {
      thread.table = thread.driver;
      return;
    }
    Member& member = member_of(context, share, server_ ? spu::remote_driver() : *thread.driver);
    spu::Chain& chain = member.chain;
    if (auto* const volumes = chain.find<spu::VolumeUnit>()) {
      if (system == WindowSystem::osmesa) volumes->never_defer_window_depth();
      volumes->draws_into(system == WindowSystem::glx ? drawable : 0);
    }
    chain.make_current();
    // Contexts that share objects with this one may have uploaded volumes since its last frame.
    chain.frame_ended(spu::FrameEnd::make_current);
  }

  void context_destroyed(std::uintptr_t context) {
    std::unique_ptr<Member> gone;
    {
      const std::scoped_lock lock(mutex_);
      const auto found = contexts_.find(context);
      if (found == contexts_.end()) return;
      gone = std::move(found->second);
      contexts_.erase(found);
    }
    // Null if there was not enough memory to create it.
    if (gone) gone->chain.abandon();
  }

  void frame_ended(spu::FrameEnd kind, std::uintptr_t window) {
    if (spu::Chain* chain = spu::Chain::current()) chain->frame_ended(kind);
    if (redraw_ && window != 0) window_shown(window);
    if (reports_itself()) spu::write_report_when_due(options_.report);
    if (!control_was_tried_.load(std::memory_order_relaxed)) start_control();
  }

  /// Another thread may be inside a context's chain, or hold the lock forever: the figures then stay as last
  /// written.
  void process_ends() {
    if (reports_itself()) spu::write_report_now(options_.report);
    // A forked child has its parent's contexts in memory, but must not write its parent's files.
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock || getpid() != process_) return;
    for (const auto& [context, member] : contexts_) {
      if (member) member->chain.process_ends();
    }
  }

  void program_ends() {
    session_->end();
    if (ViewerControl* const control = control_.load(); control != nullptr && getpid() == process_)
      control->stop();
    // A forked child must not close its parent's connection.
    if (server_ && getpid() == process_) server_->end();
  }

  /// Called in a forked child.
  void leave_control_to_parent() noexcept {
    if (ViewerControl* const control = control_.exchange(nullptr)) control->leave_to_parent();
  }

  /// True if this process has to write the report: there is no launcher that does, and it is not a forked
  /// child, which has no report of its own and must not write its parent's.
  bool reports_itself() const {
    return !options_.report.empty() && options_.run_dir.empty() && getpid() == process_;
  }

 private:
  struct Member {
    std::shared_ptr<spu::ShareGroup> group;
    spu::Chain chain;
  };

  Member& member_of(std::uintptr_t context, std::uintptr_t share, const spu::DispatchTable& driver) {
    const std::scoped_lock lock(mutex_);
    const auto found = contexts_.find(context);
    if (found != contexts_.end()) {
      // What the context has done in the meantime is unknown.
      if (!found->second)
        throw std::runtime_error("an OpenGL context could not be followed from its beginning");
      return *found->second;
    }
    auto& member = contexts_[context];
    {
      const auto relative = contexts_.find(share);
      auto group = relative != contexts_.end() && relative->second ? relative->second->group
                                                                   : std::make_shared<spu::ShareGroup>();
      member.reset(new Member{group, spu::Chain(driver, group, &install, {context, share, server_.get()})});
      if (const auto trouble = spu::assemble(member->chain, options_.chain, session_)) {
        logging::log(logging::Level::error, "{}; calls go straight to the driver", *trouble);
      }
    }
    return *member;
  }

  /// At the end of the first frame: programs that show nothing get no socket and no thread.
  void start_control();

  void window_shown(std::uintptr_t window) {
    // A forked child has no thread that asks.
    const bool can_ask = getpid() == process_ && redraw_->can_ask(window);
    const spu::LateViews late = session_->windows().frame_ended(window, can_ask);
    if (can_ask) redraw_->frame_shown(window, late);
  }

  static void install(const spu::DispatchTable* table);

  const EntryServices entry_;
  const spu::Options options_;
  const pid_t process_ = getpid();
  EntryFrontEnd front_;
  std::unique_ptr<spu::ServerConnection> server_;
  std::shared_ptr<spu::RenderSession> session_;
  std::mutex mutex_;
  std::map<std::uintptr_t, std::unique_ptr<Member>> contexts_;
  std::optional<RedrawRequest> redraw_;  ///< set if images may be a frame late
  std::atomic<bool> control_was_tried_ = false;
  std::atomic<ViewerControl*> control_ = nullptr;  ///< never destroyed: its thread may still answer
};

/// The core of this process. Never destroyed: the application may call OpenGL until its very last instruction.
constinit Core* core = nullptr;

void Core::install(const spu::DispatchTable* table) {
  core->entry_.thread_state()->table = table;
}

/// A thread reserves more than a hundred MiB of it for its stack and its memory, and drivers crash where they
/// find none.
bool address_space_is_limited() {
  rlimit limit{};
  return getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

void Core::start_control() {
  if (control_was_tried_.exchange(true) || !options_.can_be_controlled() || getpid() != process_) return;
  const bool asked_for = options_.control == "on";
  if (!asked_for && address_space_is_limited()) {
    logging::log(
        logging::Level::info,
        "`understudy ctl` cannot control this viewer, because `ulimit -v` limits its address space, of "
        "which a thread takes much; --control on does it all the same");
    return;
  }
  try {
    control_ = std::make_unique<ViewerControl>(session_).release();
    pthread_atfork(nullptr, nullptr, [] { core->leave_control_to_parent(); });
  } catch (const std::exception& error) {
    logging::log(asked_for ? logging::Level::warn : logging::Level::info,
                 "`understudy ctl` cannot control this viewer: {}", error.what());
  }
}

/// From now on the thread's calls go directly to the driver.
void leave_to_driver(const char* trouble) noexcept {
  if (spu::Chain* chain = spu::Chain::current()) return chain->give_up(trouble);
  if (core != nullptr) core->leave_to_driver();
  static constinit std::atomic_flag said{};
  if (said.test_and_set()) return;
  // There may not be enough memory for a longer line.
  std::array<char, 512> line;
  std::snprintf(line.data(), line.size(), "%s; calls go straight to the driver", trouble);
  logging::write(logging::Level::error, line.data());
}

/// Lets no exception reach the application, except the unwinding of a cancelled thread.
template <class Action>
void guarded(Action action) {
  try {
    action();
  } catch (abi::__forced_unwind&) {
    throw;
  } catch (const std::bad_alloc&) {
    leave_to_driver("there is not enough memory");
  } catch (const std::exception& error) {
    leave_to_driver(error.what());
  } catch (...) {
    leave_to_driver("an unknown error");
  }
}

void context_current(std::uintptr_t context, std::uintptr_t share, WindowSystem system, bool desktop_gl,
                     std::uintptr_t drawable) {
  guarded([&] { core->context_current(context, share, system, desktop_gl, drawable); });
}

RemoteVersions remote_versions() {
  RemoteVersions versions;
  guarded([&] { versions = core->remote_versions(); });
  return versions;
}

void context_leaving() {
  guarded([] {
    if (spu::Chain* chain = spu::Chain::current()) {
      chain->settle();
      chain->frame_ended(spu::FrameEnd::make_current);
    }
  });
  guarded([] { spu::Chain::release_current(); });
}

void context_destroyed(std::uintptr_t context) {
  guarded([&] { core->context_destroyed(context); });
}

void before_frame_end(FrameEnd) {
  guarded([] {
    if (spu::Chain* chain = spu::Chain::current()) chain->settle();
  });
}

spu::FrameEnd frame_end(FrameEnd kind) {
  switch (kind) {
    case FrameEnd::swap:
      return spu::FrameEnd::swap;
    case FrameEnd::finish:
      return spu::FrameEnd::finish;
    default:
      return spu::FrameEnd::wait;
  }
}

void after_frame_end(FrameEnd kind, std::uintptr_t window) {
  guarded([&] { core->frame_ended(frame_end(kind), window); });
}

constinit CoreServices services;

/// Runs before the libraries that the core needs are torn down; the application may keep drawing after that.
void at_program_end() {
  if (core != nullptr) core->program_ends();
}

/// If a program exits regularly, writes its last half second to the report and the units' files as well.
[[gnu::destructor]] void at_library_end() {
  if (core != nullptr) guarded([] { core->process_ends(); });
}

}  // namespace
}  // namespace understudy::interceptor

extern "C" [[gnu::visibility("default")]] const understudy::interceptor::CoreServices* understudy_open_core(
    const understudy::interceptor::EntryServices* entry) {
  using namespace understudy::interceptor;
  if (entry == nullptr || entry->abi != core_abi) return nullptr;
  try {
    understudy::spu::Options options = understudy::spu::options_from_environment();
    if (options.disable) return nullptr;
    if (core == nullptr) {
      core = new Core(*entry, std::move(options));
      std::atexit(at_program_end);
    }
  } catch (const std::exception& error) {
    const char* remote = ::secure_getenv("UNDERSTUDY_REMOTE");
    const bool has_driver = remote == nullptr || *remote == '\0';
    understudy::logging::log(understudy::logging::Level::error, "{}{}", error.what(),
                             has_driver ? "; calls go straight to the driver" : "");
    return nullptr;
  }
  services = {core_abi,         context_current, context_leaving, context_destroyed,
              before_frame_end, after_frame_end, remote_versions};
  return &services;
}
