// SPDX-License-Identifier: Apache-2.0
// A GLX program that needs no X server: handles are plain numbers, which the test driver accepts.
#include <GL/glx.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../driver/driver.h"

extern "C" int glDrawMeshNV(int, int, int, int, int, int, int, int, double, double, double, double, double,
                            double, double, double, double);
extern "C" int glGpuSyncAcquireNVX();

namespace {

Display* const display = reinterpret_cast<Display*>(7);

GLXContext create(GLXContext share = nullptr) {
  return glXCreateContext(display, nullptr, share, True);
}
bool current(GLXContext context, GLXDrawable drawable) {
  return glXMakeCurrent(display, drawable, context) != 0;
}
void release() {
  glXMakeCurrent(display, None, nullptr);
}

void one_frame() {
  glClear(0);
  GLXContext context = create();
  current(context, 10);
  glClear(0);
  glFlush();
  glXSwapBuffers(display, 10);
  release();
  glClear(0);
  glXDestroyContext(display, context);
}

void failed_make_current() {
  GLXContext context = create();
  current(context, 10);
  if (current(context, bad_drawable)) say("app: should have failed\n");
  glClear(0);
}

void same_again() {
  GLXContext context = create();
  current(context, 10);
  current(context, 10);
  glClear(0);
  current(context, 11);
}

/// The first context of a group is destroyed before the second one was ever current.
void share_group() {
  GLXContext first = create();
  current(first, 10);
  GLXContext second = create(first);
  release();
  glXDestroyContext(display, first);
  say("app: the first is destroyed\n");
  current(second, 10);
  release();
  glXDestroyContext(display, second);
}

void handle_comes_again() {
  for (int time = 0; time < 2; ++time) {
    GLXContext context = create();
    current(context, 10);
    release();
    glXDestroyContext(display, context);
  }
}

void destroyed_while_current() {
  GLXContext context = create();
  current(context, 10);
  glXDestroyContext(display, context);
  glClear(0);
  say("app: releasing\n");
  release();
}

void* clear_elsewhere(void* context) {
  current(static_cast<GLXContext>(context), 11);
  glClear(0);
  release();
  return nullptr;
}

void two_threads() {
  GLXContext first = create();
  GLXContext second = create(first);
  current(first, 10);
  glClear(0);
  pthread_t thread;
  pthread_create(&thread, nullptr, &clear_elsewhere, second);
  pthread_join(thread, nullptr);
  glClear(0);
  release();
}

void* clear_and_end(void* context) {
  current(static_cast<GLXContext>(context), 11);
  glClear(0);
  return nullptr;
}

/// The context is still current when its thread ends, and is destroyed by another thread.
void thread_ends() {
  GLXContext context = create();
  pthread_t thread;
  pthread_create(&thread, nullptr, &clear_and_end, context);
  pthread_join(thread, nullptr);
  say("app: the thread has ended\n");
  glXDestroyContext(display, context);
}

void addresses() {
  const auto address = [](const char* name) {
    return glXGetProcAddressARB(reinterpret_cast<const GLubyte*>(name));
  };
  say("app: glClear %s\n", address("glClear") == reinterpret_cast<void (*)()>(&glClear) ? "ours" : "not ours");
  say("app: glXSwapBuffers %s\n",
      address("glXSwapBuffers") == reinterpret_cast<void (*)()>(&glXSwapBuffers) ? "ours" : "not ours");
  say("app: glAccum %s\n", address("glAccum") == nullptr ? "null" : "not null");
  say("app: glNoSuchFunction %s\n", address("glNoSuchFunction") == nullptr ? "null" : "not null");
  address("glVendorFunction")();
}

void missing_function() {
  glAccum(0, 1);
  glAccum(0, 1);
  say("app: goes on\n");
}

void outside_registry() {
  current(create(), 10);
#if defined(__x86_64__)
  say("app: %d\n", glDrawMeshNV(1, 2, 3, 4, 5, 6, 7, 8, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5));
  say("app: %d\n", glGpuSyncAcquireNVX());
#endif
}

void forked() {
  GLXContext context = create();
  current(context, 10);
  glClear(0);
  const pid_t child = fork();
  if (child == 0) {
    say("app: child\n");
    glClear(0);
    glXSwapBuffers(display, 10);
    current(context, 11);
    current(create(), 10);
    glClear(0);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  say("app: parent, child's status %d\n", status);
  glClear(0);
  release();
}

/// Prints which libraries of the driver are loaded.
void libraries() {
  current(create(), 10);
  FILE* maps = fopen("/proc/self/maps", "r");
  bool glx = false;
  bool egl = false;
  char line[4096];
  while (maps != nullptr && fgets(line, sizeof line, maps) != nullptr) {
    glx |= strstr(line, "/driver/libGLX.so.0") != nullptr;
    egl |= strstr(line, "/driver/libEGL.so.1") != nullptr;
  }
  say("app: driver's GLX %s, EGL %s\n", glx ? "loaded" : "not loaded", egl ? "loaded" : "not loaded");
}

void never_current() {
  glXDestroyContext(display, create());
}

struct Scene {
  const char* name;
  void (*play)();
};
constexpr Scene scenes[] = {
    {"one_frame", one_frame},
    {"failed_make_current", failed_make_current},
    {"same_again", same_again},
    {"share_group", share_group},
    {"addresses", addresses},
    {"handle_comes_again", handle_comes_again},
    {"forked", forked},
    {"destroyed_while_current", destroyed_while_current},
    {"libraries", libraries},
    {"missing_function", missing_function},
    {"two_threads", two_threads},
    {"thread_ends", thread_ends},
    {"outside_registry", outside_registry},
    {"never_current", never_current},
};

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
