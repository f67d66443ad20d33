// SPDX-License-Identifier: Apache-2.0
// The line between the entry library and the core.
//
// libunderstudy.so, the entry library, is what applications load: exported entry points, real-driver lookup,
// nothing else. Its core (libunderstudy-core.so: chain, recognition, ray casting) is opened when the first
// context becomes current, so a program that never draws pays for neither its memory nor its libraries. They
// meet in the C structures below.
#pragma once

#include <cstdint>

#include "dispatch/table.h"  // generated: understudy::spu::DispatchTable

namespace understudy::interceptor {

/// What one thread's entry points need. Lives in the entry library (thread-local); the core changes `table`
/// when the chain's head changes (a run of slices opens or closes).
struct ThreadState {
  const spu::DispatchTable* table = nullptr;  ///< null: no context yet, calls go to the driver
  std::uint64_t* calls = nullptr;             ///< GL calls that came through the entry library on this thread
  /// The real OpenGL of the context that is current: every slot filled or null. The same for all contexts of
  /// GLX and EGL, another for those of OSMesa. Null without a context.
  const spu::DispatchTable* driver = nullptr;
};

/// Who made a context.
enum class WindowSystem : std::int32_t { glx, egl, osmesa };

/// Which call ends or publishes a frame.
enum class FrameEnd : std::int32_t {
  swap,
  finish,  ///< the image is complete, and all buffers keep their contents: OSMesa, which has no swap
  wait,
  make_current,
  destroy
};

constexpr std::uint32_t core_abi = 3;

/// What the application asked of a context that a GL server is to make.
struct RemoteContextFormat {
  std::int32_t version = 0;   ///< 100 * major + 10 * minor
  std::uint32_t profile = 0;  ///< GL_CONTEXT_PROFILE_MASK
  std::int32_t alpha = 0;
  std::int32_t depth = 0;
  std::int32_t stencil = 0;
  std::int32_t samples = 0;
  std::int32_t double_buffered = 1;
};

/// A window or an off-screen surface of the application, whose pixels a GL server has.
struct RemoteDrawable {
  std::uint64_t number = 0;  ///< 0: there is none
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::uintptr_t display = 0;  ///< 0: nobody sees it
};

/// Rows from the top, 4 bytes a pixel: blue, green, red, unused.
struct RemoteImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  const std::uint8_t* pixels = nullptr;
};

/// The highest OpenGL versions of a GL server, as 100 * major + 10 * minor; 0: none.
struct RemoteVersions {
  std::int32_t core = 0;
  std::int32_t compatibility = 0;
};

/// Given by the entry library, once.
struct EntryServices {
  std::uint32_t abi = core_abi;
  ThreadState* (*thread_state)() = nullptr;  ///< of the calling thread
  // Where a GL server makes the calls (UNDERSTUDY_REMOTE), and the entry library is the whole window system.
  // About the context that is current on the calling thread:
  void (*remote_context_format)(RemoteContextFormat*) = nullptr;
  void (*remote_drawable)(RemoteDrawable*) = nullptr;
  /// From any thread, also when the drawable is gone.
  void (*remote_show)(const RemoteDrawable*, const RemoteImage*) = nullptr;
};

/// Answered by the core, once. No function throws; all may be called from any thread.
struct CoreServices {
  std::uint32_t abi = core_abi;
  /// The calling thread has just made `context` current on the real driver, which the thread's state names.
  /// Sets the thread's table. `share` is any context of the same share group that is already known (0: none).
  /// `desktop_gl` is false for OpenGL ES contexts, which go straight to the driver. `drawable` tells frames of
  /// two windows apart.
  void (*context_current)(std::uintptr_t context, std::uintptr_t share, WindowSystem system, bool desktop_gl,
                          std::uintptr_t drawable) = nullptr;
  /// The calling thread's context is about to stop being current (or another is about to replace it).
  void (*context_leaving)() = nullptr;
  void (*context_destroyed)(std::uintptr_t context) = nullptr;
  /// Before the real call that ends or publishes a frame (swap, finish, WaitGL): what is pending must reach the
  /// framebuffer.
  void (*before_frame_end)(FrameEnd kind) = nullptr;
  /// After the real swap or finish returned.
  void (*after_frame_end)(FrameEnd kind) = nullptr;
  /// Of the GL server that makes this process's calls; zeros when there is none.
  RemoteVersions (*remote_versions)() = nullptr;
};

/// The one symbol that libunderstudy-core.so exports. Null when the core refuses (ABI mismatch,
/// UNDERSTUDY_DISABLE).
using OpenCore = const CoreServices* (*)(const EntryServices*);
constexpr const char* open_core_symbol = "understudy_open_core";

}  // namespace understudy::interceptor
