// SPDX-License-Identifier: Apache-2.0
// forks SCENE: a process that forks before or after it has a context.
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "image.h"
#include "offscreen.h"

using namespace client;

namespace {

/// Runs `act` in a child that then ends by `leave`, and waits for it.
template <class Act>
void in_child(Act act, void (*leave)(int)) {
  fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    act();
    fflush(stdout);
    leave(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  printf("the child's status is %x\n", unsigned(status));
}

void draw_anew(const char* name, int seed, Platform platform = Platform::surfaceless) {
  const Offscreen offscreen(nullptr, platform);
  offscreen.make_current();
  show(name, seed);
  offscreen.swap();
  show(name, seed + 1);
  offscreen.release();
  offscreen.destroy();
}

void before_context() {
  in_child([] { draw_anew("child", 1); }, exit);
  draw_anew("parent", 3);
}

/// The real libraries are open, but no context was ever current.
void before_context_but_after_a_call() {
  eglGetProcAddress("glClear");
  glFlush();
  in_child([] { draw_anew("child", 1); }, exit);
  draw_anew("parent", 3);
}

template <class InChild>
void with_context(InChild act, void (*leave)(int)) {
  const Offscreen offscreen;
  offscreen.make_current();
  show("parent, before", 1);
  in_child(act, leave);
  show("parent, after", 2);
  offscreen.swap();
  show("parent, after a swap", 3);
}

void child_only_exits() {
  with_context([] {}, exit);
}
void child_leaves_at_once() {
  with_context([] {}, _exit);
}
/// On a different display than the parent's, because the child lacks the threads of the parent's driver.
void child_draws_anew() {
  with_context([] { draw_anew("child", 4, Platform::device); }, _exit);
}
/// With a driver without threads (LP_NUM_THREADS=0), a child can even continue to use its parent's context.
void child_goes_on() {
  with_context([] { show("child", 5); }, _exit);
}

/// The child exits after everything else.
void child_outlives_parent() {
  const Offscreen offscreen;
  offscreen.make_current();
  show("parent", 1);
  fflush(stdout);
  int parent_is_here[2];
  if (pipe(parent_is_here) != 0) give_up("pipe");
  if (fork() != 0) return;
  close(parent_is_here[1]);
  char nothing;
  while (read(parent_is_here[0], &nothing, 1) > 0) {
  }
  exit(0);
}

struct Scene {
  const char* name;
  void (*play)();
};
constexpr Scene scenes[] = {{"before_context", before_context},
                            {"before_context_but_after_a_call", before_context_but_after_a_call},
                            {"child_only_exits", child_only_exits},
                            {"child_leaves_at_once", child_leaves_at_once},
                            {"child_draws_anew", child_draws_anew},
                            {"child_goes_on", child_goes_on},
                            {"child_outlives_parent", child_outlives_parent}};

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
