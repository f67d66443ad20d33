// SPDX-License-Identifier: Apache-2.0
// The contexts that the application has created, and which of them share objects.
//
// The driver reuses handles, so the core gets numbers instead, each used once in a process. If a context is
// destroyed while its share group has members that the core has not seen yet, the core is told only after it
// has seen one of them: otherwise it would discard textures that still exist.
#pragma once

#include <cstdint>

#include "interceptor/core.h"

namespace understudy::interceptor {

/// Identifies a context by the application's handle.
struct ContextKey {
  WindowSystem system;
  std::uintptr_t display;
  std::uintptr_t handle;
};

/// What the core is told about a context that becomes current.
struct KnownContext {
  std::uintptr_t context = 0;  ///< 0: the ledger is out of memory
  std::uintptr_t share = 0;    ///< another context of the group that is known to the core, or 0
  bool desktop_gl = true;
};

/// Records a new context, which shares objects with `share` (handle 0: with none).
void note_created(const ContextKey& key, std::uintptr_t share, bool desktop_gl);

/// The application destroyed the context; the driver keeps it until no thread has it current.
void note_destroyed(const ContextKey& key);

/// As note_destroyed, for every context of a display.
void note_display_closed(WindowSystem system, std::uintptr_t display);

/// True if the ledger has the context.
bool is_noted(const ContextKey& key);

/// Describes a known context to the core again.
KnownContext known_context(std::uintptr_t context);

/// Records that a thread made the context current: the core knows it from now on. A context whose creation was
/// not seen is added with a share group of its own.
KnownContext note_current(const ContextKey& key, bool desktop_gl_if_new);

/// No thread has the context current any more. `context` is the number that note_current returned.
void note_not_current(std::uintptr_t context);

/// Removes a destroyed context from the ledger and returns its number if the core has yet to be told; 0 if
/// there is none.
std::uintptr_t next_gone();

/// In a forked child: reinitialises the lock, which another thread of the parent may have held.
void reset_ledger_after_fork();

}  // namespace understudy::interceptor
