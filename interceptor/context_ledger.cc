// SPDX-License-Identifier: Apache-2.0
#include "interceptor/context_ledger.h"

#include <pthread.h>
#include <stdlib.h>

namespace understudy::interceptor {
namespace {

struct Entry {
  ContextKey key;
  std::uintptr_t context;
  std::uintptr_t group;  ///< the number of the group's first context
  bool desktop_gl;
  bool known_to_core;
  bool current;
  bool destroyed;
  Entry* next;
};

constinit Entry* entries = nullptr;
constinit std::uintptr_t last_number = 0;
constinit pthread_mutex_t ledger_lock = PTHREAD_MUTEX_INITIALIZER;

class Locked {
 public:
  Locked() { pthread_mutex_lock(&ledger_lock); }
  ~Locked() { pthread_mutex_unlock(&ledger_lock); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;
};

Entry* find(const ContextKey& key) {
  for (Entry* entry = entries; entry != nullptr; entry = entry->next) {
    if (!entry->destroyed && entry->key.handle == key.handle && entry->key.system == key.system) return entry;
  }
  return nullptr;
}

Entry* add(const ContextKey& key, std::uintptr_t group, bool desktop_gl) {
  auto* entry = static_cast<Entry*>(malloc(sizeof(Entry)));
  if (entry == nullptr) return nullptr;
  const std::uintptr_t number = ++last_number;
  *entry = {key, number, group != 0 ? group : number, desktop_gl, false, false, false, entries};
  entries = entry;
  return entry;
}

/// Another context of the group that the core knows, destroyed or not; null if there is none.
const Entry* known_companion(const Entry& of) {
  for (const Entry* entry = entries; entry != nullptr; entry = entry->next) {
    if (entry != &of && entry->group == of.group && entry->known_to_core) return entry;
  }
  return nullptr;
}

KnownContext description(const Entry& entry) {
  const Entry* companion = known_companion(entry);
  return {entry.context, companion != nullptr ? companion->context : 0, entry.desktop_gl};
}

/// True while the core must keep `gone`, because its group has members that the core has not seen yet.
bool holds_objects_for_others(const Entry& gone) {
  if (!gone.known_to_core || known_companion(gone) != nullptr) return false;
  for (const Entry* entry = entries; entry != nullptr; entry = entry->next) {
    if (entry->group == gone.group && !entry->destroyed) return true;
  }
  return false;
}

}  // namespace

void note_created(const ContextKey& key, std::uintptr_t share, bool desktop_gl) {
  const Locked locked;
  // A reused handle means that the previous context was destroyed unseen (its display was closed).
  if (Entry* former = find(key)) {
    former->destroyed = true;
    former->current = false;
  }
  const Entry* companion = share != 0 ? find({key.system, key.display, share}) : nullptr;
  add(key, companion != nullptr ? companion->group : 0, desktop_gl);
}

void note_destroyed(const ContextKey& key) {
  const Locked locked;
  if (Entry* entry = find(key)) entry->destroyed = true;
}

void note_display_closed(WindowSystem system, std::uintptr_t display) {
  const Locked locked;
  for (Entry* entry = entries; entry != nullptr; entry = entry->next) {
    if (entry->key.system == system && entry->key.display == display) entry->destroyed = true;
  }
}

bool is_noted(const ContextKey& key) {
  const Locked locked;
  return find(key) != nullptr;
}

KnownContext known_context(std::uintptr_t context) {
  const Locked locked;
  for (const Entry* entry = entries; entry != nullptr; entry = entry->next) {
    if (entry->context == context) return description(*entry);
  }
  return {};
}

KnownContext note_current(const ContextKey& key, bool desktop_gl_if_new) {
  const Locked locked;
  Entry* entry = find(key);
  if (entry == nullptr) entry = add(key, 0, desktop_gl_if_new);
  if (entry == nullptr) return {};
  entry->current = true;
  entry->known_to_core = true;
  return description(*entry);
}

void note_not_current(std::uintptr_t context) {
  const Locked locked;
  for (Entry* entry = entries; entry != nullptr; entry = entry->next) {
    if (entry->context == context) entry->current = false;
  }
}

std::uintptr_t next_gone() {
  const Locked locked;
  for (Entry** link = &entries; *link != nullptr;) {
    Entry* entry = *link;
    if (!entry->destroyed || entry->current || holds_objects_for_others(*entry)) {
      link = &entry->next;
      continue;
    }
    const std::uintptr_t told = entry->known_to_core ? entry->context : 0;
    *link = entry->next;
    free(entry);
    if (told != 0) return told;
  }
  return 0;
}

void reset_ledger_after_fork() {
  ledger_lock = PTHREAD_MUTEX_INITIALIZER;
}

}  // namespace understudy::interceptor
