// SPDX-License-Identifier: Apache-2.0
// The contexts that the application has made, and which of them share objects.
//
// Handles are addresses that the driver uses again; the core gets numbers instead, each used once in a process.
// When a context goes whose share group still has members that the core has never seen, the core is told only
// after it has seen one of them: else it would forget textures that live on.
#pragma once

#include <cstdint>

#include "interceptor/core.h"

namespace understudy::interceptor {

/// A context as the application names it.
struct ContextKey {
  WindowSystem system;
  std::uintptr_t display;
  std::uintptr_t handle;
};

/// What the core is told of a context that becomes current.
struct KnownContext {
  std::uintptr_t context = 0;  ///< 0: the ledger is out of memory
  std::uintptr_t share = 0;    ///< another context of the group that the core knows, 0 for none
  bool desktop_gl = true;
};

/// A context was created that shares objects with `share` (handle 0: with none).
void note_created(const ContextKey& key, std::uintptr_t share, bool desktop_gl);

/// The application destroyed it; it lives on in the driver until no thread has it current.
void note_destroyed(const ContextKey& key);

/// As note_destroyed, for every context of a display.
void note_display_closed(WindowSystem system, std::uintptr_t display);

/// True if the ledger has the context.
bool is_noted(const ContextKey& key);

/// What the core is told again of a context that it knows.
KnownContext known_context(std::uintptr_t context);

/// A thread made it current: the core knows it from now on. A context that nobody saw being created joins the
/// ledger with a share group of its own.
KnownContext note_current(const ContextKey& key, bool desktop_gl_if_new);

/// No thread has it current any more. `context` is the number that note_current answered.
void note_not_current(std::uintptr_t context);

/// The number of a context that is gone and that the core has yet to be told about, or 0. Removes it from the
/// ledger.
std::uintptr_t next_gone();

/// In a child: makes the lock anew, which another thread of the parent may have held.
void reset_ledger_after_fork();

}  // namespace understudy::interceptor
