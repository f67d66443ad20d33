// SPDX-License-Identifier: Apache-2.0
// GLX and EGL without a driver, for processes whose calls are made by a GL server (UNDERSTUDY_REMOTE).
//
// As in a small driver, unsupported functions are missing and their extensions are not announced: OpenGL ES,
// EGLImages, EGLSyncs and so on. glXCopyContext warns that it copies nothing.
#pragma once

#include "interceptor/core.h"

namespace understudy::interceptor {

/// True in a process started by `understudy run --remote`. Never changes.
bool is_remote();

/// The function that replaces the real library's; null if there is none.
void* remote_symbol(WindowSystem system, const char* name);

/// The core's queries about the calling thread's context and drawable: see EntryServices.
void remote_context_format(RemoteContextFormat* format);
void remote_drawable(RemoteDrawable* drawable);
void remote_show(const RemoteDrawable* drawable, const RemoteImage* image);

/// The highest OpenGL versions of the GL server, as 100 * major + 10 * minor; 0 without a GL server. Opens the
/// core.
RemoteVersions remote_versions();

}  // namespace understudy::interceptor
