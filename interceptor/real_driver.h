// SPDX-License-Identifier: Apache-2.0
// Finds and opens the real OpenGL and looks up its functions, without ever requesting a name of ours from the
// loader.
//
// glvnd's libGLX.so.0 and libEGL.so.1 suffice: GL functions come from libOpenGL.so.0 beside them, or from their
// GetProcAddress. Without glvnd, libGL.so.1 is opened instead. Libraries are opened when first needed: a
// program that uses only GLX never opens EGL, and vice versa. OSMesa's library contains a complete OpenGL,
// whose contexts are unknown to GLX and EGL.
#pragma once

#include "dispatch/table.h"
#include "interceptor/core.h"

namespace understudy::interceptor {

/// The real function of that name, or null. Opens the window system's library on first use. Thread-safe.
void* real_symbol(WindowSystem system, const char* name);

/// Returns the result of the real glXGetProcAddressARB, eglGetProcAddress or OSMesaGetProcAddress.
void* real_proc_address(WindowSystem system, const char* name);

/// True once the library has been opened: until then none of its contexts can be current.
bool driver_is_open(WindowSystem system);

/// Opens the window system's library if it exists; logs nothing if it does not.
bool driver_is_there(WindowSystem system);

/// The real GL functions for contexts of `system`; missing ones are null. GLX and EGL share a table.
const spu::DispatchTable& driver_table(WindowSystem system);

/// The real GL functions for a thread without a context, from a window system that is in use if there is one.
const spu::DispatchTable& driver_table_without_context();

/// The path of the folder that holds this library, without a trailing slash.
const char* own_folder();

/// The exported function of that name in this library, or null.
void* own_entry(const char* name);

/// The absolute path of a stub (a position in stub_names); empty if there is none.
const char* own_stub(int stub);

/// glibc's dlopen, bypassing our hook and any other.
void* real_dlopen(const char* name, int mode);

/// Loads the stubs of GLX and EGL, so that the SONAMEs libGL.so.1, libGLX.so.0, libOpenGL.so.0 and libEGL.so.1
/// are ours before a real library of that name is loaded: glibc first compares a requested name with the
/// SONAMEs that are loaded. OSMesa's stub is not among them: a request for OSMesa must fail where it is not
/// installed.
void claim_names();

/// Reinitialises the locks in a forked child: threads that exist only in the parent may hold them.
void reset_driver_locks_after_fork();

}  // namespace understudy::interceptor
