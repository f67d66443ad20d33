// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/window.h"

#include <SDL.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>

#include "apps/understudy/file_scene/load_progress.h"
#include "apps/understudy/view/image_encoding.h"
#include "apps/understudy/view/shown_volume.h"
#include "apps/understudy/view/view_state.h"
#include "compositor/logging/log.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;

/// Time after the last move until the image at rest is rendered.
constexpr std::chrono::milliseconds rest{150};
constexpr int wait_ms = 50;
constexpr double wheel_step = 1.15;
constexpr double key_step = 0.1;

[[noreturn]] void fail(const char* what) {
  throw std::runtime_error(
      fmt::format("{} ({}); on a machine without a display, give --web 0 and open the link in a browser", what,
                  SDL_GetError()));
}

/// Initializes SDL, and shuts it down.
struct Video {
  Video() {
    // An image can be shown without OpenGL, even where it is available.
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    SDL_SetHint(SDL_HINT_RENDER_DRIVER, "software");
    // SDL must not handle termination signals.
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) fail("no display is available for a window");
  }
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;
  ~Video() { SDL_Quit(); }
};

class Window {
 public:
  Window(const FileScene& scene, const ServiceMaker& make, const RankMemory& memory,
         const std::stop_token& stop, const WindowScript& script)
      : stop_(stop),
        script_(script),
        plays_(script.plays && scene.series.size() > 1),
        volume_(scene, make, memory),
        state_(scene),
        window_(SDL_CreateWindow(name().c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED,
                                 scene.image.width, scene.image.height, SDL_WINDOW_RESIZABLE),
                SDL_DestroyWindow) {
    if (!window_) fail("the window cannot be created");
  }

  void run() {
    try {
      load();
    } catch (const compositor::ServiceLost&) {
      if (!over_ && !stop_.stop_requested()) throw;
    }
    for (int frame = 0; !over_ && !stop_.stop_requested();) {
      try {
        if (script_.frames > 0) {
          play(frame);
          if (++frame == script_.frames) over_ = true;
        } else {
          live();
        }
      } catch (const compositor::ServiceLost& lost) {
        recover(lost.what());
      }
    }
  }

 private:
  void load() {
    volume_.load([&](const std::vector<compositor::RankLoad>& ranks) { go_on_loading(ranks); });
    due_ = true;
  }

  void go_on_loading(const std::vector<compositor::RankLoad>& ranks) {
    if (!std::ranges::all_of(ranks, &compositor::RankLoad::done)) say(progress_text(ranks));
    hear(0);
    if (over_ || stop_.stop_requested()) throw compositor::ServiceLost("the window is closed");
  }

  void recover(const std::string& why) {
    std::string reason = why;
    while (!over_ && !stop_.stop_requested()) {
      logging::log(logging::Level::warn, "the render nodes are gone ({}); reading the volume again", reason);
      say("the render nodes are gone; reading the volume again");
      hear(1000);
      try {
        return load();
      } catch (const compositor::ServiceLost& lost) {
        reason = lost.what();
      } catch (const compositor::RequestRefused& refused) {
        reason = refused.what();
      }
    }
  }

  void play(int frame) {
    ViewMessage message;
    message.still = frame + 1 == script_.frames;
    // Depends on the frame's number alone, because a frame is rendered again after nodes were lost.
    message.camera = ViewCamera{volume_.scene().image.camera, {}};
    message.camera->orbit.azimuth += frame * script_.orbit;
    if (plays_) message.time_step = step_from(volume_.scene().time_step, frame);
    state_.apply(message);
    const ShownVolume::Drawn drawn = draw();
    hear(0);
    if (!message.still || script_.save.empty()) return;
    const std::vector<std::byte> png = png_of(drawn.image);
    std::ofstream file(script_.save, std::ios::binary);
    file.write(reinterpret_cast<const char*>(png.data()), std::streamsize(png.size()));
    file.close();
    if (!file)
      throw std::runtime_error(fmt::format(
          "{} cannot be written; check that the folder exists and the disk is not full", script_.save));
  }

  void live() {
    hear(due_ || reads_ahead_ ? 0 : wait_ms);
    if (due_) {
      due_ = false;
      try {
        draw();
      } catch (const compositor::RequestRefused& refused) {
        plays_ = false;
        return say(refused.what());
      }
      reads_ahead_ = true;
      if (plays_) return play_on();
      if (state_.still())
        if (const auto exactness = volume_.exactness())
          say(fmt::format("{:.0f} ms, largest error {:.4f} of {} rays", drawn_ms_, exactness->error,
                          exactness->rays));
    } else if (!state_.still() && Clock::now() - moved_ > rest) {
      state_.apply({});
      due_ = true;
    } else if (reads_ahead_) {
      reads_ahead_ = volume_.read_ahead({});
    }
  }

  void play_on() {
    ViewMessage message;
    message.still = false;
    message.time_step = step_from(state_.time_step(), 1);
    moved_ = Clock::now();
    state_.apply(message);
    due_ = true;
  }

  /// The first time step follows the last one.
  int step_from(int step, int steps) const {
    const auto count = int(volume_.scene().series.size());
    return ((step + steps) % count + count) % count;
  }

  std::string name() const { return volume::name_of(volume_.scene().series[std::size_t(state_.time_step())]); }

  ShownVolume::Drawn draw() {
    const Clock::time_point start = Clock::now();
    const ViewState state = state_;  // input that arrives while its time step is read belongs to the next image
    ShownVolume::Drawn drawn =
        volume_.draw(state, [&](const std::vector<compositor::RankLoad>& ranks) { go_on_loading(ranks); });
    show(drawn.image);
    drawn_ms_ = std::chrono::duration<double, std::milli>(Clock::now() - start).count() - drawn.load_ms;
    state_.took({drawn.image.width, drawn.image.height}, drawn_ms_);
    last_ms_ = drawn_ms_;
    say(fmt::format("{:.0f} ms, {} x {}", drawn_ms_, drawn.image.width, drawn.image.height));
    return drawn;
  }

  void show(const RgbImage& image) {
    // No copy is needed: SDL only reads the pixels.
    auto* pixels = const_cast<std::uint8_t*>(image.rgb.data());
    const std::unique_ptr<SDL_Surface, void (*)(SDL_Surface*)> from(
        SDL_CreateRGBSurfaceWithFormatFrom(pixels, image.width, image.height, 24, 3 * image.width,
                                           SDL_PIXELFORMAT_RGB24),
        SDL_FreeSurface);
    SDL_Surface* const to = SDL_GetWindowSurface(window_.get());
    if (!from || to == nullptr) fail("the image cannot be drawn into the window");
    if (SDL_BlitScaled(from.get(), nullptr, to, nullptr) != 0 || SDL_UpdateWindowSurface(window_.get()) != 0)
      fail("the image cannot be drawn into the window");
  }

  void say(const std::string& what) {
    SDL_SetWindowTitle(window_.get(), fmt::format("{} · {}", name(), what).c_str());
  }

  void hear(int most_ms) {
    SDL_Event event;
    if (SDL_WaitEventTimeout(&event, most_ms) == 0) return;
    do take(event);
    while (SDL_PollEvent(&event) != 0);
  }

  void take(const SDL_Event& event) {
    ViewMessage message;
    message.still = false;
    switch (event.type) {
      case SDL_QUIT:
        over_ = true;
        return;
      case SDL_WINDOWEVENT:
        if (event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED)
          message.size = {std::clamp(event.window.data1, least_view_side, most_view_side),
                          std::clamp(event.window.data2, least_view_side, most_view_side)};
        else if (event.window.event == SDL_WINDOWEVENT_EXPOSED)
          message.still = state_.still();
        else
          return;
        break;
      case SDL_MOUSEMOTION: {
        const ImagePoint to = point_at(event.motion.x, event.motion.y);
        const ImagePoint from =
            point_at(event.motion.x - event.motion.xrel, event.motion.y - event.motion.yrel);
        const bool shifts = (SDL_GetModState() & KMOD_SHIFT) != 0;
        if ((event.motion.state & SDL_BUTTON_LMASK) != 0 && !shifts)
          message.rotate = {from, to};
        else if ((event.motion.state & (SDL_BUTTON_LMASK | SDL_BUTTON_MMASK | SDL_BUTTON_RMASK)) != 0)
          message.pan = {to[0] - from[0], to[1] - from[1]};
        else
          return;
        break;
      }
      case SDL_MOUSEWHEEL: {
        int x = 0, y = 0;
        SDL_GetMouseState(&x, &y);
        message.zoom = {std::pow(wheel_step, event.wheel.y), point_at(x, y)};
        break;
      }
      case SDL_KEYDOWN:
        if (event.key.repeat != 0 && event.key.keysym.sym == SDLK_SPACE) return;
        if (!take_key(event.key.keysym.sym, message)) return;
        break;
      default:
        return;
    }
    if (!message.still) moved_ = Clock::now();
    // The time of the previous image.
    if (last_ms_) message.took_ms = std::exchange(last_ms_, std::nullopt);
    state_.apply(message);
    due_ = true;
  }

  bool take_key(SDL_Keycode key, ViewMessage& message) {
    const Shading& shading = state_.image().shading;
    switch (key) {
      case SDLK_q:
      case SDLK_ESCAPE:
        over_ = true;
        return false;
      case SDLK_LEFT:
        message.rotate = {ImagePoint{0, 0}, ImagePoint{-key_step, 0}};
        return true;
      case SDLK_RIGHT:
        message.rotate = {ImagePoint{0, 0}, ImagePoint{key_step, 0}};
        return true;
      case SDLK_UP:
        message.rotate = {ImagePoint{0, 0}, ImagePoint{0, key_step}};
        return true;
      case SDLK_DOWN:
        message.rotate = {ImagePoint{0, 0}, ImagePoint{0, -key_step}};
        return true;
      case SDLK_PLUS:
      case SDLK_EQUALS:
        message.zoom = {wheel_step, {}};
        return true;
      case SDLK_MINUS:
        message.zoom = {1 / wheel_step, {}};
        return true;
      case SDLK_HOME:
        message.camera = ViewCamera{volume_.scene().image.camera, {}};
        return true;
      case SDLK_PAGEDOWN:
        message.time_step = step_from(state_.time_step(), 1);
        return true;
      case SDLK_PAGEUP:
        message.time_step = step_from(state_.time_step(), -1);
        return true;
      case SDLK_SPACE:
        plays_ = !plays_ && volume_.scene().series.size() > 1;
        return true;
      case SDLK_l:
        message.light = !shading.light.has_value();
        return true;
      case SDLK_v:
        message.shows_volume = !shading.shows_volume;
        return true;
      case SDLK_s:
        message.surfaces = shading.surfaces.empty()
                               ? std::vector<SurfaceChoice>{{0.4, true, {0.9F, 0.75F, 0.55F, 1}}}
                               : std::vector<SurfaceChoice>{};
        return true;
      case SDLK_LEFTBRACKET:
      case SDLK_RIGHTBRACKET: {
        if (shading.surfaces.empty() || !shading.surfaces.front().of_range) return false;
        message.surfaces = shading.surfaces;
        double& at = message.surfaces->front().at;
        at = std::clamp(at + (key == SDLK_LEFTBRACKET ? -0.01 : 0.01), 0.01, 1.0);
        return true;
      }
      default:
        return false;
    }
  }

  ImagePoint point_at(int x, int y) const {
    const auto& image = state_.image();
    const double half = std::min(image.width, image.height) / 2.0;
    return {(x - image.width / 2.0) / half, (image.height / 2.0 - y) / half};
  }

  const std::stop_token stop_;
  const WindowScript& script_;
  bool plays_;
  Video video_;
  ShownVolume volume_;
  ViewState state_;
  std::unique_ptr<SDL_Window, void (*)(SDL_Window*)> window_;
  bool over_ = false;
  bool due_ = true;  // whether an image has to be rendered
  bool reads_ahead_ = false;
  Clock::time_point moved_{};
  double drawn_ms_ = 0;
  std::optional<double> last_ms_;  // of the last image, until it has been reported
};

}  // namespace

void show_in_window(const FileScene& scene, const ServiceMaker& make, const RankMemory& memory,
                    const std::stop_token& stop, const WindowScript& script) {
  Window(scene, make, memory, stop, script).run();
}

}  // namespace understudy::launcher
