// A body for tests: it says what the door tells it, and which calls reach its table.
#include "interceptor/body.h"

#include <cstdlib>

#include "driver.h"

using namespace understudy::interceptor;
using understudy::spu::DispatchTable;

namespace {

DoorServices door;
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
  say("body: glClear\n");
  door.thread_state()->driver->Clear(mask);
}
void flush() {
  say("body: glFlush\n");
  door.thread_state()->driver->Flush();
}

void context_current(std::uintptr_t context, std::uintptr_t share, WindowSystem system, bool desktop_gl,
                     std::uintptr_t drawable) {
  // Where a drawable is an address it is another in every run.
  const bool address = system == WindowSystem::osmesa;
  say(address ? "body: current %lu share %lu %s %s drawable\n"
              : "body: current %lu share %lu %s %s drawable %lu\n",
      context, share, text(system), desktop_gl ? "desktop" : "es", drawable);
  ThreadState& thread = *door.thread_state();
  table = *thread.driver;
  table.Clear = &clear;
  table.Flush = &flush;
  thread.table = desktop_gl ? &table : thread.driver;
  thread.calls = &calls;
}
void context_leaving() {
  say("body: leaving after %lu calls\n", calls);
  calls = 0;
}
void context_destroyed(std::uintptr_t context) {
  say("body: destroyed %lu\n", context);
}
void before_frame_end(FrameEnd kind) {
  say("body: before %s\n", text(kind));
}
void after_frame_end(FrameEnd kind) {
  say("body: after %s\n", text(kind));
}

RemoteVersions remote_versions() {
  return {};
}

const BodyServices services{body_abi,          &context_current, &context_leaving, &context_destroyed,
                            &before_frame_end, &after_frame_end, &remote_versions};

}  // namespace

DRIVER_FUNCTION const BodyServices* understudy_open_body(const DoorServices* services_of_door) {
  say("body: open\n");
  if (std::getenv("TEST_BODY_REFUSES") != nullptr) return nullptr;
  door = *services_of_door;
  return &services;
}
