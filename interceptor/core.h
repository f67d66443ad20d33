// SPDX-License-Identifier: Apache-2.0
// The interface between the entry library and the core library, in plain C structures.
//
// Applications load the entry library, libunderstudy.so: exported functions and the search for the real driver,
// nothing else. The core library (libunderstudy-core.so: chain, recognition, ray casting) is opened when the
// first context becomes current, so a program that never draws does not pay for its memory and its libraries.
//
#pragma once

#include <cstdint>

#include "dispatch/table.h"  // generated: understudy::spu::DispatchTable

namespace understudy::interceptor {

/// What the entry points need for each thread. Belongs to the entry library (thread-local); the core changes
/// `table` when the chain's first unit changes (a run of slices begins or ends).
struct ThreadState {
  const spu::DispatchTable* table = nullptr;  ///< null: no context yet, calls go to the driver
  std::uint64_t* calls = nullptr;             ///< GL calls of this thread that came through the entry library
  /// The real OpenGL of the current context: every slot is filled or null. GLX and EGL contexts share one
  /// table, OSMesa contexts have another. Null without a context.
  const spu::DispatchTable* driver = nullptr;
};

/// The interface that created a context.
enum class WindowSystem : std::int32_t { glx, egl, osmesa };

/// The kind of call that ends or publishes a frame.
enum class FrameEnd : std::int32_t {
  swap,
  finish,  ///< the image is complete and all buffers keep their contents: OSMesa, which has no swap
  wait,
  make_current,
  destroy
};

constexpr std::uint32_t core_abi = 4;

/// The format that the application requested for a context on a GL server.
struct RemoteContextFormat {
  std::int32_t version = 0;   ///< 100 * major + 10 * minor
  std::uint32_t profile = 0;  ///< GL_CONTEXT_PROFILE_MASK
  std::int32_t alpha = 0;
  std::int32_t depth = 0;
  std::int32_t stencil = 0;
  std::int32_t samples = 0;
  std::int32_t double_buffered = 1;
};

/// A window or off-screen surface of the application whose pixels are on a GL server.
struct RemoteDrawable {
  std::uint64_t number = 0;  ///< 0: there is none
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::uintptr_t display = 0;  ///< 0: not visible
};

/// Rows from top to bottom, 4 bytes per pixel: blue, green, red, unused.
struct RemoteImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  const std::uint8_t* pixels = nullptr;
};

/// The highest OpenGL versions of a GL server, as 100 * major + 10 * minor; 0 if not supported.
struct RemoteVersions {
  std::int32_t core = 0;
  std::int32_t compatibility = 0;
};

/// Passed to the core by the entry library, once.
struct EntryServices {
  std::uint32_t abi = core_abi;
  ThreadState* (*thread_state)() = nullptr;  ///< of the calling thread
  // Used when a GL server makes the calls (UNDERSTUDY_REMOTE) and the entry library is the window system. Both
  // describe the context that is current on the calling thread:
  void (*remote_context_format)(RemoteContextFormat*) = nullptr;
  void (*remote_drawable)(RemoteDrawable*) = nullptr;
  /// May be called from any thread, even after the drawable was destroyed.
  void (*remote_show)(const RemoteDrawable*, const RemoteImage*) = nullptr;
};

/// Returned by the core, once. No function throws; all may be called from any thread.
struct CoreServices {
  std::uint32_t abi = core_abi;
  /// The calling thread has just made `context` current on the real driver (ThreadState::driver). Sets the
  /// thread's table. `share` is any known context of the same share group (0: none). `desktop_gl` is false for
  /// OpenGL ES contexts, whose calls go directly to the driver. `drawable` distinguishes the frames of two
  /// windows.
  void (*context_current)(std::uintptr_t context, std::uintptr_t share, WindowSystem system, bool desktop_gl,
                          std::uintptr_t drawable) = nullptr;
  /// The calling thread's context is about to stop being current (or another is about to replace it).
  void (*context_leaving)() = nullptr;
  void (*context_destroyed)(std::uintptr_t context) = nullptr;
  /// Called before the real call that ends or publishes a frame (swap, finish, WaitGL): writes everything
  /// pending to the framebuffer.
  void (*before_frame_end)(FrameEnd kind) = nullptr;
  /// After the real swap or finish returned. `window` is the drawable of GLX that was swapped as a whole,
  /// whether or not the thread's context draws into it; otherwise 0.
  void (*after_frame_end)(FrameEnd kind, std::uintptr_t window) = nullptr;
  /// Versions of the GL server that makes this process's calls; zeros if there is none.
  RemoteVersions (*remote_versions)() = nullptr;
};

/// The only symbol that libunderstudy-core.so exports. Returns null if the core cannot be used (ABI mismatch,
/// UNDERSTUDY_DISABLE).
using OpenCore = const CoreServices* (*)(const EntryServices*);
constexpr const char* open_core_symbol = "understudy_open_core";

}  // namespace understudy::interceptor
