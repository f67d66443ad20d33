// SPDX-License-Identifier: Apache-2.0
// A viewer that redraws only if something has changed: rotates a volume for some frames, then rests, and
// redraws a window when it is exposed. Writes what its windows show just after the last rotation to
// FILE.turning, and what they show in the end to FILE: rows of RGB bytes, top row first.
//
//   turns_and_rests FILE FRAMES [VIEWS]
//
// VIEWS, each of which turns in its own way:
//   one        a view (the default)
//   viewports  two, side by side in a window
//   windows    two windows of one context
//   threads    two windows, each with a context and a thread: the second writes FILE.other
//   eyes       two eyes of an anaglyph, in red, and in green and blue
//   in_turn    two in one place, one after the other in every frame, as if the program put them together itself
//   hidden     a view in which an opaque square moves through the volume
//   followed   a view in which the volume moves to the right, and an opaque square follows it closely
// With VIEWS, writes what each view shows before each swap to FILE.view0 and FILE.view1: frames of RGB bytes.
#include <GL/gl.h>
#include <GL/glext.h>
#include <GL/glx.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

constexpr int edge = 256;
constexpr int texels = 32;

struct View {
  std::size_t window = 0;  ///< number of its window
  int x = 0;               ///< of its viewport
  bool clears = true;      ///< its window, before it is drawn
  std::array<GLboolean, 3> written{GL_TRUE, GL_TRUE, GL_TRUE};
  float first_angle = 0;
  float angle_per_frame = 4;
  float first_x = 0;  ///< of the volume's centre
  float x_per_frame = 0;
};

enum class Square { none, moves, follows };

struct Scene {
  std::vector<View> views;
  std::size_t windows = 1;
  int first_x = 0;   ///< of the first window
  int width = edge;  ///< of a window
  Square square = Square::none;
  int balls_z = 10;  ///< the texels' slice with the centres of the balls; greater numbers are nearer
};

constexpr View second_view{.first_angle = 50, .angle_per_frame = -6};

Scene scene_of(const std::string& name) {
  constexpr View first;
  View second = second_view;
  if (name == "hidden") return {.views = {first}, .square = Square::moves};
  if (name == "followed") {
    View moving = first;
    moving.angle_per_frame = 0;
    moving.first_x = -1.65F;
    moving.x_per_frame = 0.3F;
    return {.views = {moving}, .square = Square::follows, .balls_z = 24};
  }
  if (name == "one" || name == "threads") return {.views = {first}};
  if (name == "in_turn") return {.views = {first, second}};
  if (name == "windows") {
    second.window = 1;
    return {.views = {first, second}, .windows = 2};
  }
  second.clears = false;
  if (name == "viewports") {
    second.x = edge;
    return {.views = {first, second}, .width = 2 * edge};
  }
  if (name != "eyes") return {};
  View left = first;
  left.written = {GL_TRUE, GL_FALSE, GL_FALSE};
  second.written = {GL_FALSE, GL_TRUE, GL_TRUE};
  return {.views = {left, second}};
}

/// Two balls of different colours, so that no two views are equal.
std::vector<unsigned char> balls(int centre_z) {
  std::vector<unsigned char> rgba;
  const auto ball = [=](double x, double y, double z, double cx) {
    const double dx = x - cx, dy = y - 16, dz = z - centre_z;
    return std::exp(-(dx * dx + dy * dy + dz * dz) / 30);
  };
  for (int z = 0; z < texels; ++z)
    for (int y = 0; y < texels; ++y)
      for (int x = 0; x < texels; ++x) {
        const double red = ball(x, y, z, 9), blue = ball(x, y, z, 22);
        for (const double part : {red, 0.2, blue, 0.5 * std::max(red, blue)})
          rgba.push_back(static_cast<unsigned char>(255 * part));
      }
  return rgba;
}

void define_volume(int balls_z) {
  const auto image_3d = reinterpret_cast<PFNGLTEXIMAGE3DPROC>(
      glXGetProcAddressARB(reinterpret_cast<const GLubyte*>("glTexImage3D")));
  glBindTexture(GL_TEXTURE_3D, 1);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
  image_3d(GL_TEXTURE_3D, 0, GL_RGBA8, texels, texels, texels, 0, GL_RGBA, GL_UNSIGNED_BYTE,
           balls(balls_z).data());
}

constexpr float square_z = -1.9F;

/// Draws an opaque square in front of the volume.
void draw_square(float left, float right) {
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
  glTranslatef(0, 0, square_z);
  glColor3f(0, 1, 0);
  glRectf(left, -0.2F, right, 0.2F);
  glColor3f(1, 1, 1);
  glDepthMask(GL_FALSE);
}

void draw_volume(float x, float angle) {
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
  glTranslatef(x, 0, -3);
  glRotatef(angle, 0, 1, 0);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_TEXTURE_3D);
  constexpr int slices = 48;
  for (int i = 0; i < slices; ++i) {
    const float z = (static_cast<float>(i) + 0.5F) / slices;
    glBegin(GL_QUADS);
    for (const auto& [x, y] :
         {std::pair{0.F, 0.F}, std::pair{1.F, 0.F}, std::pair{1.F, 1.F}, std::pair{0.F, 1.F}}) {
      glTexCoord3f(x, y, z);
      glVertex3f(2 * x - 1, 2 * y - 1, 2 * z - 1);
    }
    glEnd();
  }
  glDisable(GL_TEXTURE_3D);
}

class Viewer {
 public:
  Viewer(Display* display, XVisualInfo* visual, Scene scene, std::string file)
      : display_(display), scene_(std::move(scene)), file_(std::move(file)) {
    for (std::size_t i = 0; i < scene_.windows; ++i) windows_.push_back(create_window(visual));
    context_ = glXCreateContext(display_, visual, nullptr, True);
    make_current(0);
    glMatrixMode(GL_PROJECTION);
    glFrustum(-0.7, 0.7, -0.7, 0.7, 1, 10);
    define_volume(scene_.balls_z);
  }
  ~Viewer() {
    glXMakeCurrent(display_, None, nullptr);
    glXDestroyContext(display_, context_);
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  void record_views() { records_ = true; }

  void draw(std::size_t window, int frame) {
    make_current(window);
    std::vector<const View*> drawn;
    for (const View& view : scene_.views) {
      if (view.window != window) continue;
      // What is cleared now must have been looked at.
      if (view.clears) write_views(drawn);
      draw(view, frame);
      drawn.push_back(&view);
    }
    write_views(drawn);
    glXSwapBuffers(display_, windows_[window]);
  }
  void draw_all(int frame) {
    for (std::size_t i = 0; i < windows_.size(); ++i) draw(i, frame);
  }

  /// Redraws windows that have been exposed since the last call. Returns how many.
  int redraw_exposed(int frame) {
    int redrawn = 0;
    for (const std::size_t window : exposed()) {
      draw(window, frame);
      ++redrawn;
    }
    return redrawn;
  }
  /// Returns the windows that have been exposed since the last call.
  std::vector<std::size_t> exposed() {
    std::vector<bool> is_exposed(windows_.size());
    while (XPending(display_) > 0) {
      XEvent event;
      XNextEvent(display_, &event);
      if (event.type != Expose) continue;
      for (std::size_t i = 0; i < windows_.size(); ++i)
        if (event.xexpose.window == windows_[i]) is_exposed[i] = true;
    }
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < windows_.size(); ++i)
      if (is_exposed[i]) found.push_back(i);
    return found;
  }

  void write_windows(const std::string& file) {
    XSync(display_, False);
    std::ofstream out(file, std::ios::binary);
    for (const Window window : windows_) {
      XImage* const image = XGetImage(display_, window, 0, 0, unsigned(scene_.width), edge, AllPlanes, ZPixmap);
      for (int y = 0; y < edge; ++y)
        for (int x = 0; x < scene_.width; ++x) {
          const unsigned long pixel = XGetPixel(image, x, y);
          for (const int shift : {16, 8, 0}) out.put(static_cast<char>((pixel >> shift) & 0xff));
        }
      XDestroyImage(image);
    }
  }

 private:
  void make_current(std::size_t window) { glXMakeCurrent(display_, windows_[window], context_); }

  Window create_window(XVisualInfo* visual) {
    const Window root = RootWindow(display_, visual->screen);
    XSetWindowAttributes attributes{};
    attributes.colormap = XCreateColormap(display_, root, visual->visual, AllocNone);
    attributes.event_mask = ExposureMask;
    // Beside each other, so that none covers another.
    const int x = scene_.first_x + int(windows_.size()) * (scene_.width + 8);
    const Window window = XCreateWindow(display_, root, x, 0, unsigned(scene_.width), edge, 0, visual->depth,
                                        InputOutput, visual->visual, CWColormap | CWEventMask, &attributes);
    XMapWindow(display_, window);
    XEvent event;
    XWindowEvent(display_, window, ExposureMask, &event);
    return window;
  }

  void draw(const View& view, int frame) {
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    if (view.clears) glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glViewport(view.x, 0, edge, edge);
    glColorMask(view.written[0], view.written[1], view.written[2], GL_TRUE);
    const float x = view.first_x + view.x_per_frame * static_cast<float>(frame);
    const float inside = 0.1F * static_cast<float>(frame % 8) - 0.4F;
    if (scene_.square == Square::moves) draw_square(inside, inside + 0.4F);
    // Beside the volume, where it was in the frame before.
    const float side = square_z * (1 - x) / 2;
    if (scene_.square == Square::follows) draw_square(side + 0.05F * square_z, side + 0.02F * square_z);
    draw_volume(x, view.first_angle + view.angle_per_frame * static_cast<float>(frame));
  }

  /// Appends what each of the views shows to its file, and forgets them.
  void write_views(std::vector<const View*>& views) {
    if (records_)
      for (const View* view : views) {
        std::vector<unsigned char> rgb(std::size_t{3} * edge * edge);
        glPixelStorei(GL_PACK_ALIGNMENT, 1);
        glReadPixels(view->x, 0, edge, edge, GL_RGB, GL_UNSIGNED_BYTE, rgb.data());
        for (std::size_t i = 0; i < rgb.size(); ++i)
          if (view->written[i % 3] == GL_FALSE) rgb[i] = 0;
        const auto number = std::to_string(view - scene_.views.data());
        std::ofstream(file_ + ".view" + number, std::ios::binary | std::ios::app)
            .write(reinterpret_cast<const char*>(rgb.data()), std::streamsize(rgb.size()));
      }
    views.clear();
  }

  Display* display_;
  Scene scene_;
  std::string file_;
  std::vector<Window> windows_;
  GLXContext context_ = nullptr;
  bool records_ = false;
};

/// Turns the views for `frames` frames and then rests. Returns how often windows were drawn again.
int turn_and_rest(const Scene& scene, const std::string& file, int frames, bool records) {
  // A connection of its own for each thread.
  Display* const display = XOpenDisplay(nullptr);
  if (display == nullptr) return -1;
  int wanted[] = {GLX_RGBA, GLX_DOUBLEBUFFER, GLX_RED_SIZE, 8,   GLX_GREEN_SIZE, 8, GLX_BLUE_SIZE,
                  8,        GLX_DEPTH_SIZE,   24,           None};
  XVisualInfo* const visual = glXChooseVisual(display, DefaultScreen(display), wanted);
  if (visual == nullptr) return -1;
  int redrawn = 0;
  {
    Viewer viewer(display, visual, scene, file);
    if (records) viewer.record_views();
    for (int frame = 0; frame < frames; ++frame) viewer.draw_all(frame);
    viewer.write_windows(file + ".turning");
    viewer.exposed();

    // From now on nothing moves.
    for (auto until = Clock::now() + std::chrono::seconds(3); Clock::now() < until;) {
      if (const int now = viewer.redraw_exposed(frames - 1)) {
        redrawn += now;
        until = Clock::now() + std::chrono::milliseconds(500);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    viewer.write_windows(file);
  }
  XCloseDisplay(display);
  return redrawn;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string file = argv[1], views = argc > 3 ? argv[3] : "one";
  const int frames = std::atoi(argv[2]);
  const Scene scene = scene_of(views);
  if (scene.views.empty()) return 2;
  XInitThreads();
  int redrawn = 0;
  if (views == "threads") {
    Scene other = scene;
    other.views[0] = second_view;
    other.first_x = edge + 8;
    std::thread thread([&] { turn_and_rest(other, file + ".other", frames, true); });
    redrawn = turn_and_rest(scene, file, frames, true);
    thread.join();
  } else {
    redrawn = turn_and_rest(scene, file, frames, argc > 3);
  }
  if (redrawn < 0) return 3;
  std::printf("drawn again %d times\n", redrawn);
}
