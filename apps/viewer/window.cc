// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/window.h"

#include <GL/glew.h>
// GLEW must be included before every other OpenGL header.
#include <GL/freeglut.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <utility>

#include "apps/viewer/frames.h"
#include "apps/viewer/function_loading.h"
#include "apps/viewer/model/error.h"
#include "apps/viewer/scene.h"

namespace viewer {

namespace {

constexpr unsigned char escape_key = 27;
constexpr int wheel_up_button = 3;
constexpr int wheel_down_button = 4;
constexpr double zoom_steps_per_pixel = 0.05;

// freeglut cannot continue after this error: when its handler returns, it uses a display that does not exist.
[[noreturn]] void leave_without_display(const char* format, va_list arguments, void*) {
  char reason[256];
  std::vsnprintf(reason, sizeof reason, format, arguments);
  fmt::print(stderr,
             "understudy-viewer: no window: {}; set DISPLAY to a running X server, or use --offscreen\n",
             reason);
  std::exit(static_cast<int>(ExitCode::no_opengl));
}

class Window {
 public:
  Window(const Options& options, Volume volume) : options_(options), camera_(options.camera) {
    open();
    load_opengl_functions();
    scene_.emplace(options_, std::move(volume));
    frames_.emplace(options_, *scene_);
  }

  void run() {
    glutMainLoop();
    if (failure_) std::rethrow_exception(failure_);
    frames_->print_median();
  }

 private:
  void open();
  void draw();
  void press_key(unsigned char key);
  void press_button(int button, int state, int x, int y);
  void drag(int x, int y);

  // Exceptions must not pass through freeglut, which is written in C.
  template <typename Action>
  static void guarded(void* self, Action action) {
    auto* window = static_cast<Window*>(self);
    if (!window->scene_) return;
    try {
      action(*window);
    } catch (...) {
      window->failure_ = std::current_exception();
      glutLeaveMainLoop();
    }
  }

  const Options& options_;
  Camera camera_;
  std::optional<Scene> scene_;
  std::optional<Frames> frames_;
  std::exception_ptr failure_;
  int pressed_button_ = -1;
  int last_x_ = 0;
  int last_y_ = 0;
};

void Window::open() {
  int argument_count = 1;
  char name[] = "understudy-viewer";
  char* arguments[] = {name, nullptr};
  glutInitErrorFuncUcall(leave_without_display, nullptr);
  glutInit(&argument_count, arguments);
  if (options_.mode == ModeKind::core) {
    glutInitContextVersion(3, 3);
    glutInitContextProfile(GLUT_CORE_PROFILE);
  }
  const unsigned alpha = options_.op == Operator::under ? GLUT_ALPHA : 0;
  glutInitDisplayMode(GLUT_RGBA | GLUT_DOUBLE | GLUT_DEPTH | alpha);
  glutInitWindowSize(options_.window_size[0], options_.window_size[1]);
  glutSetOption(GLUT_ACTION_ON_WINDOW_CLOSE, GLUT_ACTION_GLUTMAINLOOP_RETURNS);
  glutCreateWindow(fmt::format("{} - understudy-viewer", options_.volume_path).c_str());

  glutDisplayFuncUcall([](void* self) { guarded(self, [](Window& window) { window.draw(); }); }, this);
  glutKeyboardFuncUcall([](unsigned char key, int, int,
                           void* self) { guarded(self, [=](Window& window) { window.press_key(key); }); },
                        this);
  glutMouseFuncUcall(
      [](int button, int state, int x, int y, void* self) {
        guarded(self, [=](Window& window) { window.press_button(button, state, x, y); });
      },
      this);
  glutMotionFuncUcall(
      [](int x, int y, void* self) { guarded(self, [=](Window& window) { window.drag(x, y); }); }, this);
  // The scene's OpenGL objects must be deleted while their context exists.
  glutCloseFuncUcall([](void* self) { static_cast<Window*>(self)->scene_.reset(); }, this);
}

void Window::draw() {
  if (frames_->finished()) return;
  // A window can be shrunk to zero size.
  const int width = std::max(glutGet(GLUT_WINDOW_WIDTH), 1), height = std::max(glutGet(GLUT_WINDOW_HEIGHT), 1);
  frames_->draw_next(camera_, width, height, [] { glutSwapBuffers(); });
  if (frames_->finished()) {
    glutLeaveMainLoop();
  } else if (options_.frames > 0 || options_.orbit != 0) {
    glutPostRedisplay();
  }
}

void Window::press_key(unsigned char key) {
  if (key == 'q' || key == escape_key) {
    glutLeaveMainLoop();
  } else if (key == 'o') {
    camera_.orthographic = !camera_.orthographic;
  } else if (const Preset* preset = find_preset(std::string_view(reinterpret_cast<const char*>(&key), 1))) {
    scene_->set_preset(*preset);
  } else {
    return;
  }
  glutPostRedisplay();
}

void Window::press_button(int button, int state, int x, int y) {
  if (button == wheel_up_button || button == wheel_down_button) {
    if (state == GLUT_DOWN) zoom(camera_, button == wheel_up_button ? 1 : -1);
    glutPostRedisplay();
    return;
  }
  pressed_button_ = state == GLUT_DOWN ? button : -1;
  last_x_ = x;
  last_y_ = y;
}

void Window::drag(int x, int y) {
  if (pressed_button_ == GLUT_LEFT_BUTTON) rotate(camera_, x - last_x_, y - last_y_);
  if (pressed_button_ == GLUT_RIGHT_BUTTON) zoom(camera_, (last_y_ - y) * zoom_steps_per_pixel);
  last_x_ = x;
  last_y_ = y;
  glutPostRedisplay();
}

}  // namespace

void run_window(const Options& options, Volume volume) {
  Window window(options, std::move(volume));
  window.run();
}

}  // namespace viewer
