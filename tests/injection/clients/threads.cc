// SPDX-License-Identifier: Apache-2.0
// threads shared|apart|volumes: two threads draw many images at the same time, each with its own context, which
// shares objects with the other one or not.
#include <pthread.h>
#include <sched.h>
#include <string.h>

#include <atomic>

#include "image.h"
#include "offscreen.h"

using namespace client;

#if defined(__SANITIZE_ADDRESS__)
/// Suppresses leak reports for memory that Mesa keeps until the process ends.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() {
  return "leak:_dri.so\nleak:libEGL_mesa\nleak:libLLVM\n";
}
#endif

namespace {

constexpr int images = 200;  // of about 60 calls each
constexpr int volumes = 6;

struct Player {
  const Offscreen* offscreen;
  GLuint texture;
  int number;
  bool draws_volumes;
  std::uint64_t digests;
  std::vector<unsigned char> last;
};

std::atomic<int> ready = 0;

void* play(void* argument) {
  auto& player = *static_cast<Player*>(argument);
  player.offscreen->make_current();
  // Both threads start at the same time.
  ++ready;
  while (ready < 2) sched_yield();
  if (player.draws_volumes) {
    const GLuint ball = player.texture != 0 ? player.texture : ball_texture();
    for (int i = 0; i < volumes; ++i) {
      draw_volume(ball, 10 * i);
      player.last = read_pixels();
      player.offscreen->swap();
    }
  } else {
    for (int i = 0; i < images; ++i) {
      const GLuint own = checkerboard(i + player.number);
      draw_image(player.texture != 0 && i % 2 == 0 ? player.texture : own, i + player.number);
      player.digests = player.digests * 31 + digest(read_pixels());
      glDeleteTextures(1, &own);
      if (i % 8 == 0) player.offscreen->swap();
      // Contexts are made and destroyed while the other thread draws.
      if (i % 50 == 0) {
        const Offscreen passing(player.offscreen);
        passing.make_current();
        glClear(GL_COLOR_BUFFER_BIT);
        player.offscreen->make_current();
        passing.destroy();
      }
    }
  }
  player.offscreen->release();
  return nullptr;
}

/// TBB is not instrumented: ThreadSanitizer does not see how it passes a task to a worker. On one processor TBB
/// has no workers, so everything that the two threads share is Understudy's.
void stay_on_one_processor() {
#if defined(__SANITIZE_THREAD__)
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(sched_getcpu(), &one);
  if (sched_setaffinity(0, sizeof one, &one) != 0) give_up("sched_setaffinity");
#endif
}

}  // namespace

int main(int count, char** arguments) {
  stay_on_one_processor();
  const bool shared = strcmp(arguments[1], "shared") == 0 || strcmp(arguments[1], "shared_volume") == 0;
  const bool draws_volumes = strstr(arguments[1], "volume") != nullptr;
  const Offscreen first;
  const Offscreen second(shared ? &first : nullptr);
  GLuint texture = 0;
  if (shared) {
    first.make_current();
    texture = draws_volumes ? ball_texture() : checkerboard(77);
    glFinish();
    first.release();
  }
  Player players[] = {{&first, texture, 1, draws_volumes, 0, {}}, {&second, texture, 2, draws_volumes, 0, {}}};
  pthread_t threads[2];
  for (int i = 0; i < 2; ++i) pthread_create(&threads[i], nullptr, &play, &players[i]);
  for (const pthread_t thread : threads) pthread_join(thread, nullptr);
  for (const Player& player : players)
    if (!draws_volumes) printf("thread %d: %016lx\n", player.number, player.digests);
  std::vector<unsigned char> both = players[0].last;
  both.insert(both.end(), players[1].last.begin(), players[1].last.end());
  if (draws_volumes && count > 2) write_file(arguments[2], both);
  puts("done");
}
