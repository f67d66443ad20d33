// SPDX-License-Identifier: Apache-2.0
// A core library for tests: prints the entry library's notifications, and the calls that reach its table.
#include "interceptor/core.h"

#include <cstdlib>

#include "driver.h"

using namespace understudy::interceptor;
using understudy::spu::DispatchTable;

namespace {

EntryServices entry;
thread_local DispatchTable table;
thread_local std::uint64_t calls = 0;

const char* text(FrameEnd kind) {
  switch (kind) {
    case FrameEnd::swap:
      return "swap";
    case FrameEnd::finish:
      return "finish";
    case FrameEnd::wait:
      return "wait";
    case FrameEnd::make_current:
      return "make_current";
    case FrameEnd::destroy:
      return "destroy";
  }
  return "?";
}

const char* text(WindowSystem system) {
  switch (system) {
    case WindowSystem::glx:
      return "glx";
    case WindowSystem::egl:
      return "egl";
    case WindowSystem::osmesa:
      return "osmesa";
  }
  return "?";
}

void clear(GLbitfield mask) {
  say("core: glClear\n");
  entry.thread_state()->driver->Clear(mask);
}
void flush() {
  say("core: glFlush\n");
  entry.thread_state()->driver->Flush();
}

void context_current(std::uintptr_t context, std::uintptr_t share, WindowSystem system, bool desktop_gl,
                     std::uintptr_t drawable) {
  // A drawable that is an address differs in every run.
  const bool address = system == WindowSystem::osmesa;
  say(address ? "core: current %lu share %lu %s %s drawable\n"
              : "core: current %lu share %lu %s %s drawable %lu\n",
      context, share, text(system), desktop_gl ? "desktop" : "es", drawable);
  ThreadState& thread = *entry.thread_state();
  table = *thread.driver;
  table.Clear = &clear;
  table.Flush = &flush;
  thread.table = desktop_gl ? &table : thread.driver;
  thread.calls = &calls;
}
void context_leaving() {
  say("core: leaving after %lu calls\n", calls);
  calls = 0;
}
void context_destroyed(std::uintptr_t context) {
  say("core: destroyed %lu\n", context);
}
void before_frame_end(FrameEnd kind) {
  say("core: before %s\n", text(kind));
}
void after_frame_end(FrameEnd kind, std::uintptr_t window) {
  say(window == 0 ? "core: after %s\n" : "core: after %s of %lu\n", text(kind), window);
}

RemoteVersions remote_versions() {
  return {};
}

const CoreServices services{core_abi,          &context_current, &context_leaving, &context_destroyed,
                            &before_frame_end, &after_frame_end, &remote_versions};

}  // namespace

DRIVER_FUNCTION const CoreServices* understudy_open_core(const EntryServices* entry_services) {
  say("core: open\n");
  if (std::getenv("TEST_CORE_REFUSES") != nullptr) return nullptr;
  entry = *entry_services;
  return &services;
}
