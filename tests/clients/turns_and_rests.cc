// SPDX-License-Identifier: Apache-2.0
// A viewer that redraws only if something has changed: rotates a volume for some frames, then rests, and
// redraws when its window is exposed. Writes what its window shows just after the last rotation to
// FILE.turning, and what it shows in the end to FILE: rows of RGB bytes, top row first.
//
//   turns_and_rests FILE FRAMES
#include <GL/gl.h>
#include <GL/glext.h>
#include <GL/glx.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

constexpr int edge = 256;
constexpr int texels = 32;

/// Two balls of different colours, so that no two views are equal.
std::vector<unsigned char> balls() {
  std::vector<unsigned char> rgba;
  const auto ball = [](double x, double y, double z, double cx) {
    const double dx = x - cx, dy = y - 16, dz = z - 10;
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

void draw(Display* display, Window window, int frame) {
  glClear(GL_COLOR_BUFFER_BIT);
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
  glTranslatef(0, 0, -3);
  glRotatef(4.0F * static_cast<float>(frame), 0, 1, 0);
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
  glXSwapBuffers(display, window);
}

void write_window(Display* display, Window window, const std::string& file) {
  XSync(display, False);
  XImage* const image = XGetImage(display, window, 0, 0, edge, edge, AllPlanes, ZPixmap);
  std::ofstream out(file, std::ios::binary);
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) {
      const unsigned long pixel = XGetPixel(image, x, y);
      for (const int shift : {16, 8, 0}) out.put(static_cast<char>((pixel >> shift) & 0xff));
    }
  XDestroyImage(image);
}

/// Whether the window has been exposed since the last query.
bool is_exposed(Display* display) {
  bool exposed = false;
  while (XPending(display) > 0) {
    XEvent event;
    XNextEvent(display, &event);
    exposed |= event.type == Expose;
  }
  return exposed;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  Display* const display = XOpenDisplay(nullptr);
  if (display == nullptr) return 3;
  int wanted[] = {GLX_RGBA, GLX_DOUBLEBUFFER, GLX_RED_SIZE, 8, GLX_GREEN_SIZE, 8, GLX_BLUE_SIZE, 8, None};
  XVisualInfo* const visual = glXChooseVisual(display, DefaultScreen(display), wanted);
  if (visual == nullptr) return 4;
  const Window root = RootWindow(display, visual->screen);
  XSetWindowAttributes attributes{};
  attributes.colormap = XCreateColormap(display, root, visual->visual, AllocNone);
  attributes.event_mask = ExposureMask;
  const Window window = XCreateWindow(display, root, 0, 0, edge, edge, 0, visual->depth, InputOutput,
                                      visual->visual, CWColormap | CWEventMask, &attributes);
  XMapWindow(display, window);
  XEvent event;
  XWindowEvent(display, window, ExposureMask, &event);
  GLXContext const context = glXCreateContext(display, visual, nullptr, True);
  glXMakeCurrent(display, window, context);

  glViewport(0, 0, edge, edge);
  glMatrixMode(GL_PROJECTION);
  glFrustum(-0.7, 0.7, -0.7, 0.7, 1, 10);
  const auto image_3d = reinterpret_cast<PFNGLTEXIMAGE3DPROC>(
      glXGetProcAddressARB(reinterpret_cast<const GLubyte*>("glTexImage3D")));
  glBindTexture(GL_TEXTURE_3D, 1);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
  image_3d(GL_TEXTURE_3D, 0, GL_RGBA8, texels, texels, texels, 0, GL_RGBA, GL_UNSIGNED_BYTE, balls().data());

  const int frames = std::atoi(argv[2]);
  for (int frame = 0; frame < frames; ++frame) draw(display, window, frame);
  write_window(display, window, std::string(argv[1]) + ".turning");
  is_exposed(display);

  // From now on nothing moves.
  int redrawn = 0;
  for (auto until = Clock::now() + std::chrono::seconds(3); Clock::now() < until;) {
    if (is_exposed(display)) {
      draw(display, window, frames - 1);
      ++redrawn;
      until = Clock::now() + std::chrono::milliseconds(500);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  write_window(display, window, argv[1]);
  std::printf("drawn again %d times\n", redrawn);
  glXMakeCurrent(display, None, nullptr);
  glXDestroyContext(display, context);
  XCloseDisplay(display);
}
