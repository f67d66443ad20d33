// SPDX-License-Identifier: Apache-2.0
#include "interceptor/remote/context.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>

#include "interceptor/entry_thread.h"
#include "interceptor/log_line.h"
#include "interceptor/remote.h"

namespace understudy::interceptor {
namespace {

constexpr int most_choices = 8;

constinit thread_local RemoteThread thread_state;
constinit pthread_mutex_t context_lock = PTHREAD_MUTEX_INITIALIZER;
constinit const RemoteConfig* choices[most_choices] = {};
constinit int choice_count = 0;

class Locked {
 public:
  Locked() { pthread_mutex_lock(&context_lock); }
  ~Locked() { pthread_mutex_unlock(&context_lock); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;
};

/// Requires the lock.
void let_go(RemoteContext* context) {
  if (context == nullptr) return;
  --context->current;
  if (context->destroyed && context->current <= 0) free(context);
}

}  // namespace

const RemoteThread& remote_thread() {
  return thread_state;
}

RemoteThread remote_thread(WindowSystem system) {
  return thread_state.system == system ? thread_state : RemoteThread{};
}

RemoteContext* new_remote_context(const RemoteConfig& config, const RemoteContextWish& wish,
                                  const RemoteContext* /*share*/) {
  const RemoteVersions there = remote_versions();
  const int highest = wish.core ? there.core : there.compatibility;
  if (highest == 0 || wish.version > highest) return nullptr;
  auto* context = static_cast<RemoteContext*>(calloc(1, sizeof(RemoteContext)));
  if (context == nullptr) return nullptr;
  context->config = config;
  context->wish = wish;
  // As drivers do: the highest version that still contains all older functions.
  if (wish.version < 320) context->wish.version = there.compatibility;
  return context;
}

void say_no_opengl_es() {
  static constinit std::atomic_flag said{};
  if (said.test_and_set()) return;
  log_line(logging::Level::warn,
           "the viewer asks for OpenGL ES, which run --remote does not offer; let it use OpenGL, or run it "
           "without --remote");
}

void destroy_remote_context(RemoteContext* context) {
  const Locked locked;
  if (context == nullptr) return;
  context->destroyed = true;
  if (context->current <= 0) free(context);
}

void enter_remote_context(const RemoteThread& thread) {
  const Locked locked;
  ++thread.context->current;
  let_go(thread_state.context);
  thread_state = thread;
}

void leave_remote_context(WindowSystem system) {
  if (thread_state.system != system) return;
  const Locked locked;
  let_go(thread_state.context);
  thread_state = {};
}

void note_choice(const RemoteConfig& config) {
  const Locked locked;
  for (int i = 0; i < choice_count; ++i) {
    if (choices[i]->visual != config.visual) continue;
    choices[i] = &config;
    return;
  }
  if (choice_count < most_choices) choices[choice_count++] = &config;
}

const RemoteConfig& chosen_for(const RemoteConfig& any_of_the_visual) {
  const Locked locked;
  for (int i = 0; i < choice_count; ++i) {
    if (choices[i]->visual == any_of_the_visual.visual) return *choices[i];
  }
  return any_of_the_visual;
}

}  // namespace understudy::interceptor
