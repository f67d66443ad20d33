// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/web_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "apps/understudy/file_scene/load_progress.h"
#include "apps/understudy/view/page_messages.h"
#include "apps/understudy/view/secret.h"
#include "apps/understudy/view/shown_volume.h"
#include "apps/understudy/view/view_message.h"
#include "apps/understudy/view/web_server.h"
#include "compositor/logging/log.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;
using Viewer = WebServer::Viewer;

constexpr std::size_t secret_bytes = 16;
/// Pause between two attempts to reconnect to nodes.
constexpr std::chrono::seconds a_while{1};
/// Time without requests before the error check of an image at rest begins, so that the next
/// request is not delayed by it.
constexpr std::chrono::milliseconds calm{100};
/// Number of rays that are checked of an image at rest.
constexpr std::size_t enough_rays = 256;
/// Interval between progress messages while loading.
constexpr std::chrono::milliseconds progress_interval{100};

class WebView {
 public:
  WebView(const FileScene& scene, const ServiceMaker& make, const RankMemory& memory,
          const std::stop_token& stop, const WebAddress& address)
      : scene_(scene),
        stop_(stop),
        volume_(scene, make, memory),
        server_(address.host, address.port, random_digits(secret_bytes),
                {[this](Viewer viewer) { join(viewer); },
                 [this](Viewer viewer, std::string_view text) { hear(viewer, text); },
                 [this](Viewer viewer) { sent(viewer); }, [this](Viewer viewer) { leave(viewer); }}) {
    if (const std::size_t points = scene.image.control_points.control_points.size();
        points > max_view_control_points)
      throw std::invalid_argument(
          fmt::format("a page edits transfer functions of at most {} control points, not of {}; thin the table "
                      "out, or use the window (without --web)",
                      max_view_control_points, points));
  }

  const WebServer& server() const { return server_; }

  void run() {
    load();
    while (!stop_.stop_requested()) {
      try {
        serve();
      } catch (const compositor::ServiceLost& lost) {
        recover(lost.what());
      }
    }
  }

 private:
  struct Session {
    ViewState state;
    bool wants_image = false;
    bool is_sent_one = false;  ///< an image for it is still being sent
  };

  /// Thrown if an image is no longer needed.
  struct Superseded {};

  /// Error check of an image at rest, which its viewer already has.
  struct ErrorCheck {
    Viewer viewer = 0;
    std::uint64_t sequence = 0;
    Clock::time_point begins;
    std::vector<compositor::RankLoad> ranks;
    ShownVolume::Exactness exactness;
  };

  // Called on the server's thread.

  void join(Viewer viewer) {
    const std::lock_guard lock(mutex_);
    Session& session = sessions_.emplace(viewer, Session{ViewState(scene_)}).first->second;
    server_.send_text(viewer, status_);
    if (is_ready_) server_.send_text(viewer, volume_message(volume_, session.state));
  }

  void hear(Viewer viewer, std::string_view text) {
    const std::lock_guard lock(mutex_);
    const auto found = sessions_.find(viewer);
    if (found == sessions_.end()) return;
    try {
      // Replaces an earlier request that has not been started.
      found->second.state.apply(decode_view_message(text));
      found->second.wants_image = true;
    } catch (const MalformedView& error) {
      server_.send_text(viewer, refusal_message(found->second.state.sequence(), error.what()));
    }
    something_new_.notify_all();
  }

  void sent(Viewer viewer) {
    const std::lock_guard lock(mutex_);
    if (const auto found = sessions_.find(viewer); found != sessions_.end()) found->second.is_sent_one = false;
    something_new_.notify_all();
  }

  void leave(Viewer viewer) {
    const std::lock_guard lock(mutex_);
    sessions_.erase(viewer);
  }

  // Called on the thread of run().

  void say(Readiness readiness, std::string_view text, double done) {
    const std::lock_guard lock(mutex_);
    is_ready_ = readiness == Readiness::ready;
    status_ = status_message(readiness, text, done);
    server_.send_text_to_all(status_);
  }

  void load() {
    std::optional<Clock::time_point> said;
    say(Readiness::loading, "loading", 0);
    volume_.load([&](const std::vector<compositor::RankLoad>& ranks) {
      if (stop_.stop_requested()) throw compositor::ServiceLost("stopped");
      if (said && Clock::now() - *said < progress_interval) return;
      said = Clock::now();
      say(Readiness::loading, progress_text(ranks), share_done(ranks));
    });
    say(Readiness::ready, "", 1);
    const std::lock_guard lock(mutex_);
    for (const auto& [viewer, session] : sessions_)
      server_.send_text(viewer, volume_message(volume_, session.state));
  }

  void recover(const std::string& why) {
    error_check_.reset();
    std::string reason = why;
    while (!stop_.stop_requested()) {
      // The rest of the message addresses applications, which can draw by themselves.
      reason = reason.substr(0, reason.find(';'));
      logging::log(logging::Level::warn, "the render nodes are gone ({}); reading the volume again", reason);
      say(Readiness::lost,
          fmt::format(
              "The render nodes are gone ({}). The volume is read again as soon as new nodes are available.",
              reason),
          0);
      pause();
      try {
        return load();
      } catch (const compositor::ServiceLost& lost) {
        reason = lost.what();
      } catch (const compositor::RequestRefused& refused) {
        reason = refused.what();
      }
    }
  }

  void pause() {
    std::unique_lock lock(mutex_);
    something_new_.wait_for(lock, stop_, a_while, [] { return false; });
  }

  /// Returns the session whose turn it is, in round-robin order.
  std::map<Viewer, Session>::iterator next_session() {
    const auto wants = [](const auto& entry) { return entry.second.wants_image && !entry.second.is_sent_one; };
    const auto after = sessions_.upper_bound(last_);
    const auto found = std::find_if(after, sessions_.end(), wants);
    if (found != sessions_.end()) return found;
    const auto before = std::find_if(sessions_.begin(), after, wants);
    return before != after ? before : sessions_.end();
  }

  void serve() {
    std::optional<ViewState> state;
    Viewer viewer = 0;
    {
      std::unique_lock lock(mutex_);
      const auto is_wanted = [&] { return next_session() != sessions_.end(); };
      if (error_check_ && !something_new_.wait_until(lock, stop_, error_check_->begins, is_wanted)) {
        lock.unlock();
        try {
          return examine();
        } catch (const compositor::RequestRefused&) {
          return error_check_.reset();  // the image has been sent; only its figures are missing
        }
      }
      if (reads_ahead_ && !is_wanted()) {
        lock.unlock();
        return read_ahead();
      }
      if (!something_new_.wait(lock, stop_, is_wanted)) return;
      error_check_.reset();
      const auto session = next_session();
      viewer = last_ = session->first;
      session->second.wants_image = false;
      session->second.is_sent_one = true;
      state = session->second.state;
    }
    try {
      draw_for(viewer, *state);
    } catch (const compositor::RequestRefused& refused) {
      refuse(viewer, *state, refused.what());
    } catch (const std::invalid_argument& error) {
      refuse(viewer, *state, error.what());
    } catch (const Superseded&) {
      sent(viewer);
    } catch (const compositor::ServiceLost&) {
      const std::lock_guard lock(mutex_);
      if (const auto session = sessions_.find(viewer); session != sessions_.end()) {
        session->second.is_sent_one = false;
        session->second.wants_image = true;
      }
      throw;
    }
  }

  /// Called while the time step of an image is read: throws if the viewer has requested another time
  /// step, or has disconnected.
  void stop_if_superseded(Viewer viewer, const ViewState& state) {
    if (stop_.stop_requested()) throw compositor::ServiceLost("stopped");
    const std::lock_guard lock(mutex_);
    const auto session = sessions_.find(viewer);
    if (session == sessions_.end() ||
        (session->second.wants_image && session->second.state.time_step() != state.time_step()))
      throw Superseded();
  }

  void draw_for(Viewer viewer, const ViewState& state) {
    const Clock::time_point start = Clock::now();
    const ShownVolume::Drawn drawn = volume_.draw(
        state, [&](const std::vector<compositor::RankLoad>&) { stop_if_superseded(viewer, state); });
    server_.send_image(viewer, image_message(scene_, state, drawn));
    reads_ahead_ = true;
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count() - drawn.load_ms;
    {
      const std::lock_guard lock(mutex_);
      const auto session = sessions_.find(viewer);
      if (session == sessions_.end()) return;
      session->second.state.took({drawn.image.width, drawn.image.height}, ms);
      // No request has to wait for figures.
      if (!state.still() || next_session() != sessions_.end()) return;
    }
    error_check_ = {viewer, state.sequence(), Clock::now() + calm, {}, {}};
  }

  /// Sends the figures of the ranks for the last image, then checks a few of its rays in each call, while
  /// there are no other requests.
  void examine() {
    if (error_check_->ranks.empty()) {
      error_check_->ranks = volume_.ranks();
      server_.send_text(error_check_->viewer,
                        figures_message(error_check_->sequence, scene_, {}, error_check_->ranks));
      return;
    }
    const auto more = volume_.exactness();
    if (!more) return error_check_.reset();
    ShownVolume::Exactness& seen = error_check_->exactness;
    seen = {std::max(seen.error, more->error), seen.rays + more->rays};
    server_.send_text(error_check_->viewer,
                      figures_message(error_check_->sequence, scene_, seen, error_check_->ranks));
    if (seen.rays >= enough_rays || more->rays == 0) error_check_.reset();
  }

  void read_ahead() {
    std::vector<int> in_use;
    {
      const std::lock_guard lock(mutex_);
      for (const auto& [viewer, session] : sessions_) in_use.push_back(session.state.time_step());
    }
    reads_ahead_ = volume_.read_ahead(in_use);
  }

  void refuse(Viewer viewer, const ViewState& state, const char* reason) {
    server_.send_text(viewer, refusal_message(state.sequence(), reason));
    sent(viewer);
  }

  const FileScene& scene_;
  const std::stop_token stop_;
  ShownVolume volume_;
  std::optional<ErrorCheck> error_check_;
  bool reads_ahead_ = false;  ///< whether more of the next time step may have to be read
  std::mutex mutex_;
  std::condition_variable_any something_new_;
  std::map<Viewer, Session> sessions_;
  Viewer last_ = 0;
  bool is_ready_ = false;
  std::string status_ = status_message(Readiness::loading, "loading", 0);
  WebServer server_;  // destroyed first
};

}  // namespace

void show_on_web(const FileScene& scene, const ServiceMaker& make, const RankMemory& memory,
                 const std::stop_token& stop, const WebAddress& address) {
  WebView view(scene, make, memory, stop, address);
  std::printf("understudy: open this link in a browser: %s\n", view.server().link().c_str());
  std::fflush(stdout);
  view.run();
}

}  // namespace understudy::launcher
