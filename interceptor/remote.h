// SPDX-License-Identifier: Apache-2.0
// GLX and EGL without a driver, for processes whose calls are made by a GL server (UNDERSTUDY_REMOTE).
//
// What is not offered is missing, as it would be in a small driver, and the extension string does not
// announce it: OpenGL ES, EGLImages, EGLSyncs and so on. glXCopyContext says that it copies nothing.
#pragma once

#include "interceptor/core.h"

namespace understudy::interceptor {

/// True in a process that `understudy run --remote` has started. Never changes.
bool is_remote();

/// What stands in the real library's place; null where nothing does.
void* remote_symbol(WindowSystem system, const char* name);

/// What the core asks, about the calling thread's context: see EntryServices.
void remote_context_format(RemoteContextFormat* format);
void remote_drawable(RemoteDrawable* drawable);
void remote_show(const RemoteDrawable* drawable, const RemoteImage* image);

/// The highest OpenGL versions of the GL server, as 100 * major + 10 * minor; 0 without a GL server. Opens the
/// core.
RemoteVersions remote_versions();

}  // namespace understudy::interceptor
