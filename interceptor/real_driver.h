// SPDX-License-Identifier: Apache-2.0
// The real OpenGL: found, opened and looked up without ever asking the loader for a name that is ours.
//
// glvnd's libGLX.so.0 and libEGL.so.1 are enough: GL functions come from libOpenGL.so.0 beside them, or from
// their GetProcAddress. Where there is no glvnd, libGL.so.1 is opened instead. Nothing is opened before it is
// needed, and a program that uses GLX alone never opens EGL, nor the other way round. OSMesa's library holds a
// whole OpenGL of its own, with contexts that GLX and EGL know nothing of.
#pragma once

#include "dispatch/table.h"
#include "interceptor/core.h"

namespace understudy::interceptor {

/// The real function of that name, or null. Opens the window system's library on first use. Thread-safe.
void* real_symbol(WindowSystem system, const char* name);

/// What the real glXGetProcAddressARB, eglGetProcAddress or OSMesaGetProcAddress answers.
void* real_proc_address(WindowSystem system, const char* name);

/// True once that library has been opened: until then no context of it can be current.
bool driver_is_open(WindowSystem system);

/// Opens the window system's library if there is one, and says nothing if there is none.
bool driver_is_there(WindowSystem system);

/// The real GL functions for contexts of `system`; null where the driver has none. GLX and EGL share a table.
const spu::DispatchTable& driver_table(WindowSystem system);

/// The real GL functions for a thread without a context: of a window system that is in use, if one is.
const spu::DispatchTable& driver_table_without_context();

/// The path of this library's folder, without the last slash.
const char* own_folder();

/// Our own exported function of that name, or null.
void* own_entry(const char* name);

/// The absolute path of a stub (a position in stub_names); empty if there is none.
const char* own_stub(int stub);

/// glibc's dlopen, past our hook and everybody else's.
void* real_dlopen(const char* name, int mode);

/// Loads the stub libraries of GLX and EGL, so that the SONAMEs libGL.so.1, libGLX.so.0, libOpenGL.so.0 and
/// libEGL.so.1 belong to us before a real library of that name is loaded: glibc compares a requested name with
/// those first. OSMesa's is not among them: a program that asks for that library where there is none must be
/// told so.
void claim_names();

/// Locks of a process that forked may be held by threads that its child does not have.
void reset_driver_locks_after_fork();

}  // namespace understudy::interceptor
