// SPDX-License-Identifier: Apache-2.0
// oddities SCENE: valid but unusual lifetimes of contexts.
#include <pthread.h>
#include <string.h>

#include "image.h"
#include "offscreen.h"

using namespace client;

namespace {

/// Without a context OpenGL does nothing; under an injection method the result must be the same.
void no_context() {
  glClear(GL_COLOR_BUFFER_BIT);
  GLuint texture = 7;
  glGenTextures(1, &texture);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, 4, 4, 4, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  printf("texture %u, version %s, error %x\n", texture, glGetString(GL_VERSION) == nullptr ? "none" : "some",
         glGetError());
  const Offscreen offscreen;
  offscreen.make_current();
  show("with", 1);
  offscreen.release();
  glClear(GL_COLOR_BUFFER_BIT);
  printf("released: version %s\n", glGetString(GL_VERSION) == nullptr ? "none" : "some");
  offscreen.make_current();
  show("again", 2);
}

void* draw_and_end(void* offscreen) {
  static_cast<const Offscreen*>(offscreen)->make_current();
  show("thread", 3);
  return nullptr;  // the context stays current
}

/// Mesa's EGL keeps such a context for the ended thread: no other thread can make it current, but it can be
/// destroyed.
void thread_ends_with_context() {
  const Offscreen main_context;
  for (int i = 0; i < 3; ++i) {
    Offscreen offscreen(&main_context);
    pthread_t thread;
    pthread_create(&thread, nullptr, &draw_and_end, &offscreen);
    pthread_join(thread, nullptr);
    main_context.make_current();
    show("main", 4);
    main_context.release();
    offscreen.destroy();
  }
}

/// Uses eglGetProcAddress for all functions that draw, as toolkits do.
void by_address() {
  const Offscreen offscreen;
  offscreen.make_current();
  const auto clear_color = reinterpret_cast<decltype(&glClearColor)>(eglGetProcAddress("glClearColor"));
  const auto clear = reinterpret_cast<decltype(&glClear)>(eglGetProcAddress("glClear"));
  const auto read = reinterpret_cast<decltype(&glReadPixels)>(eglGetProcAddress("glReadPixels"));
  const auto swap = reinterpret_cast<decltype(&eglSwapBuffers)>(eglGetProcAddress("eglSwapBuffers"));
  if (clear_color == nullptr || clear == nullptr || read == nullptr || swap == nullptr)
    give_up("eglGetProcAddress");
  clear_color(0.2F, 0.4F, 0.6F, 1);
  clear(GL_COLOR_BUFFER_BIT);
  unsigned char pixel[4] = {};
  read(1, 1, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
  printf("%d %d %d %d, %s\n", pixel[0], pixel[1], pixel[2], pixel[3],
         eglGetProcAddress("eglNoSuchFunction") == nullptr ? "none such" : "some such");
}

struct Scene {
  const char* name;
  void (*play)();
};
constexpr Scene scenes[] = {{"no_context", no_context},
                            {"thread_ends_with_context", thread_ends_with_context},
                            {"by_address", by_address}};

}  // namespace

int main(int, char** arguments) {
  for (const Scene& scene : scenes) {
    if (strcmp(arguments[1], scene.name) == 0) {
      scene.play();
      return 0;
    }
  }
  return 2;
}
