// SPDX-License-Identifier: Apache-2.0
#include "interceptor/open_core.h"

#include <dlfcn.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <atomic>
#include <initializer_list>

#include "interceptor/address_space.h"
#include "interceptor/context_ledger.h"
#include "interceptor/entry_thread.h"
#include "interceptor/log_line.h"
#include "interceptor/real_driver.h"
#include "interceptor/remote.h"

namespace understudy::interceptor {

constinit thread_local EntryThread entry_thread;

namespace {

constinit std::atomic<const CoreServices*> opened = nullptr;
constinit std::atomic<bool> out = false;
constinit pid_t opened_by = 0;  ///< set before the core is opened
constinit pthread_mutex_t opening = PTHREAD_MUTEX_INITIALIZER;

ThreadState* state_of_this_thread() {
  return &entry_thread.state;
}

/// The core's threads stay in the parent, so the child must not call the core. A context that it inherits is
/// used with the driver alone, and its calls must not be counted in memory that the parent shares with the
/// launcher.
void leave_core_after_fork() {
  out.store(true);
  entry_thread.state.table = nullptr;
  entry_thread.state.calls = &entry_thread.spare_calls;
  entry_thread.current = {};
}

/// Only the forking thread exists in the child: what other threads had begun is abandoned.
void child_after_fork() {
  opening = PTHREAD_MUTEX_INITIALIZER;
  reset_driver_locks_after_fork();
  reset_ledger_after_fork();
  if (opened_by != 0) leave_core_after_fork();
}

__attribute__((constructor)) void watch_forks() {
  pthread_atfork(nullptr, nullptr, &child_after_fork);
}

/// The values are those that switch an option on in spu/options.cc. The core reports invalid ones.
bool switched_off() {
  const char* value = secure_getenv("UNDERSTUDY_DISABLE");
  if (value == nullptr) return false;
  for (const char* on : {"1", "on", "yes", "true"}) {
    if (strcmp(value, on) == 0) return true;
  }
  return false;
}

bool complete(const CoreServices& services) {
  return services.abi == core_abi && services.context_current != nullptr &&
         services.context_leaving != nullptr && services.context_destroyed != nullptr &&
         services.before_frame_end != nullptr && services.after_frame_end != nullptr &&
         services.remote_versions != nullptr;
}

const CoreServices* load_core() {
  if (switched_off()) return nullptr;
  const unsigned long left = address_space_left();
  if (left < address_space_needed()) {
    log_line(logging::Level::error,
             "`ulimit -v` leaves this program %lu MiB of address space, and %lu are needed, so the application "
             "draws "
             "by itself",
             left, address_space_needed());
    return nullptr;
  }

  static constinit EntryServices entry;
  entry.thread_state = &state_of_this_thread;
  entry.remote_context_format = &remote_context_format;
  entry.remote_drawable = &remote_drawable;
  entry.remote_show = &remote_show;

  char path[PATH_MAX];
  const int length = snprintf(path, sizeof path, "%s/libunderstudy-core.so", own_folder());
  if (length < 0 || length >= static_cast<int>(sizeof path)) return nullptr;
  const InsideCore inside;
  void* library = real_dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    log_line(logging::Level::error, "its core cannot be opened, so the application draws by itself: %s",
             dlerror());
    return nullptr;
  }
  const auto open = reinterpret_cast<OpenCore>(dlsym(library, open_core_symbol));
  const CoreServices* services = open != nullptr ? open(&entry) : nullptr;
  if (services == nullptr || !complete(*services)) {
    log_line(logging::Level::error,
             "%s declined or is of another version (this entry library speaks version %u), so the application "
             "draws by itself",
             path, core_abi);
    return nullptr;
  }
  return services;
}

}  // namespace

bool core_is_out() {
  return out.load(std::memory_order_acquire);
}

const CoreServices* core() {
  return core_is_out() ? nullptr : opened.load(std::memory_order_acquire);
}

const CoreServices* open_core() {
  if (core_is_out()) return nullptr;
  if (const CoreServices* services = opened.load(std::memory_order_acquire)) {
    // fork runs the handler above; a bare clone() does not.
    if (opened_by == getpid()) return services;
    child_after_fork();
    return nullptr;
  }
  pthread_mutex_lock(&opening);
  if (!out.load() && opened.load() == nullptr) {
    opened_by = getpid();
    const CoreServices* services = load_core();
    if (services != nullptr) {
      opened.store(services, std::memory_order_release);
    } else {
      out.store(true, std::memory_order_release);
    }
  }
  pthread_mutex_unlock(&opening);
  return core();
}

}  // namespace understudy::interceptor
