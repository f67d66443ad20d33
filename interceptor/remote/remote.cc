// SPDX-License-Identifier: Apache-2.0
#include "interceptor/remote.h"

#include <stdlib.h>
#include <string.h>

#include <atomic>

#include "interceptor/entry_thread.h"
#include "interceptor/open_core.h"
#include "interceptor/real_driver.h"
#include "interceptor/remote/context.h"
#include "interceptor/remote/x_server.h"

namespace understudy::interceptor {

bool is_remote() {
  static constinit std::atomic<int> known = -1;
  int is = known.load(std::memory_order_relaxed);
  if (is < 0) {
    const char* address = secure_getenv("UNDERSTUDY_REMOTE");
    is = address != nullptr && *address != '\0' ? 1 : 0;
    known.store(is, std::memory_order_relaxed);
  }
  return is != 0;
}

void* remote_symbol(WindowSystem system, const char* name) {
  // OpenGL's own functions are our exports; whether the GL server has one shows only when it is called.
  if (strncmp(name, "gl", 2) == 0 && strncmp(name, "glX", 3) != 0) return own_entry(name);
  return system == WindowSystem::egl ? remote_egl_symbol(name) : remote_glx_symbol(name);
}

RemoteVersions remote_versions() {
  const CoreServices* services = open_core();
  if (services == nullptr) return {};
  const InsideCore inside;
  return services->remote_versions();
}

void remote_context_format(RemoteContextFormat* format) {
  *format = {};
  const RemoteContext* context = remote_thread().context;
  if (context == nullptr) return;
  constexpr std::uint32_t core_profile_bit = 1;
  constexpr std::uint32_t compatibility_profile_bit = 2;
  *format = {context->wish.version,          context->wish.core ? core_profile_bit : compatibility_profile_bit,
             context->config.alpha,          context->config.depth,
             context->config.stencil,        context->config.samples,
             context->config.double_buffered};
}

void remote_drawable(RemoteDrawable* drawable) {
  const RemoteThread& thread = remote_thread();
  *drawable = {};
  if (thread.context == nullptr) return;
  const auto ask = thread.system == WindowSystem::egl ? &remote_egl_drawable : &remote_glx_drawable;
  ask(thread.display, thread.draw, drawable);
}

void remote_show(const RemoteDrawable* drawable, const RemoteImage* image) {
  if (drawable->display == 0) return;
  put_image(reinterpret_cast<Display*>(drawable->display), drawable->number, *image);
}

}  // namespace understudy::interceptor
