#include "interceptor/real_driver.h"

#include <dlfcn.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <atomic>
#include <initializer_list>

#include "dispatch/call_id.h"
#include "interceptor/door_thread.h"
#include "interceptor/gl_names.h"

namespace understudy::interceptor {
namespace {

using GetProcAddress = void* (*)(const char*);

struct DriverLibrary {
  std::atomic<void*> handle = nullptr;
  GetProcAddress get_proc_address = nullptr;
  bool failed = false;  ///< looked for and not found: not looked for again
};

constinit DriverLibrary glx_library;
constinit DriverLibrary egl_library;
constinit void* opengl_handle = nullptr;  ///< libOpenGL.so.0, or libGL.so.1 where there is no glvnd
constinit spu::DispatchTable real_functions{};
constinit std::atomic<bool> real_functions_filled = false;
constinit bool real_functions_complete = false;
constinit pthread_mutex_t driver_lock = PTHREAD_RECURSIVE_MUTEX_INITIALIZER_NP;

constinit char folder_of_this_library[PATH_MAX] = {};
constinit StubPaths stubs{};

/// Runs as the library is loaded: a relative LD_PRELOAD means something only until the program changes its
/// folder.
__attribute__((constructor)) void find_own_folder() {
  Dl_info info;
  if (dladdr(&glx_library, &info) == 0 || info.dli_fname == nullptr) return;
  if (realpath(info.dli_fname, folder_of_this_library) == nullptr) return;
  if (char* slash = strrchr(folder_of_this_library, '/')) *slash = '\0';
  char door[PATH_MAX];
  const int length = snprintf(door, sizeof door, "%s/door", folder_of_this_library);
  if (length > 0 && length < static_cast<int>(sizeof door)) stubs.set_folder(door);
}

class Locked {
 public:
  Locked() { pthread_mutex_lock(&driver_lock); }
  ~Locked() { pthread_mutex_unlock(&driver_lock); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;
};

/// Opens FOLDER/NAME. The spelling FOLDER/./NAME keeps glibc from taking the real library for what an
/// application means that later asks for it by its usual absolute path: such a request must still reach the
/// auditor.
void* open_in(const char* folder, const char* name) {
  char path[PATH_MAX];
  const int length = snprintf(path, sizeof path, "%s/./%s", folder, name);
  if (length < 0 || length >= static_cast<int>(sizeof path) || access(path, R_OK) != 0) return nullptr;
  return real_dlopen(path, RTLD_LAZY | RTLD_LOCAL);
}

/// Uses `folder` for the window system if a driver is there that is not ourselves.
bool open_from(const char* folder, WindowSystem system, DriverLibrary& library) {
  const bool glx = system == WindowSystem::glx;
  const char* get_proc_address = glx ? "glXGetProcAddressARB" : "eglGetProcAddress";
  void* handle = open_in(folder, glx ? "libGLX.so.0" : "libEGL.so.1");
  const bool classic = glx && handle == nullptr;
  if (classic) handle = open_in(folder, "libGL.so.1");
  if (handle == nullptr) return false;

  void* const found = dlsym(handle, get_proc_address);
  if (found == nullptr || found == own_entry(get_proc_address)) return false;  // a stub of ours: look further

  library.get_proc_address = reinterpret_cast<GetProcAddress>(found);
  if (opengl_handle == nullptr) opengl_handle = classic ? handle : open_in(folder, "libOpenGL.so.0");
  library.handle.store(handle, std::memory_order_release);
  return true;
}

/// The folder of the C library: the one folder that is certainly right for this process's architecture.
bool libc_folder(char (&folder)[PATH_MAX]) {
  Dl_info info;
  if (dladdr(reinterpret_cast<void*>(&getenv), &info) == 0 || info.dli_fname == nullptr) return false;
  const char* slash = strrchr(info.dli_fname, '/');
  if (slash == nullptr || slash - info.dli_fname >= PATH_MAX) return false;
  memcpy(folder, info.dli_fname, static_cast<std::size_t>(slash - info.dli_fname));
  folder[slash - info.dli_fname] = '\0';
  return true;
}

/// The folders that the loader itself would look into: LD_LIBRARY_PATH and the program's RPATH first, so that a
/// user who gave the application a driver of its own gets that one.
bool open_from_search_path(WindowSystem system, DriverLibrary& library) {
  void* program = real_dlopen(nullptr, RTLD_LAZY);
  Dl_serinfo size;
  if (program == nullptr || dlinfo(program, RTLD_DI_SERINFOSIZE, &size) != 0) return false;
  auto* folders = static_cast<Dl_serinfo*>(malloc(size.dls_size));
  if (folders == nullptr) return false;
  bool opened = false;
  if (dlinfo(program, RTLD_DI_SERINFOSIZE, folders) == 0 && dlinfo(program, RTLD_DI_SERINFO, folders) == 0) {
    for (unsigned i = 0; i < folders->dls_cnt && !opened; ++i) {
      opened = open_from(folders->dls_serpath[i].dls_name, system, library);
    }
  }
  free(folders);
  return opened;
}

bool open_driver(WindowSystem system, DriverLibrary& library) {
  if (const char* folder = getenv("UNDERSTUDY_DRIVER_DIR"); folder != nullptr && *folder != '\0') {
    if (open_from(folder, system, library)) return true;
    dprintf(STDERR_FILENO,
            "understudy: UNDERSTUDY_DRIVER_DIR=%s holds no %s that can be opened and is not Understudy's own; "
            "looking in the system's folders\n",
            folder, system == WindowSystem::glx ? "libGLX.so.0 or libGL.so.1" : "libEGL.so.1");
  }
  if (open_from_search_path(system, library)) return true;
  char folder[PATH_MAX];
  if (libc_folder(folder) && open_from(folder, system, library)) return true;
  for (const char* usual : {"/usr/lib/x86_64-linux-gnu", "/usr/lib64", "/usr/lib", "/lib64"}) {
    if (open_from(usual, system, library)) return true;
  }
  dprintf(STDERR_FILENO,
          "understudy: no OpenGL driver found: no %s in UNDERSTUDY_DRIVER_DIR, LD_LIBRARY_PATH or the system's "
          "library "
          "folders; set UNDERSTUDY_DRIVER_DIR to the folder that holds it\n",
          system == WindowSystem::glx ? "libGLX.so.0 or libGL.so.1" : "libEGL.so.1");
  return false;
}

/// Null when the driver is not to be had; said once.
DriverLibrary* open_library(WindowSystem system) {
  DriverLibrary& library = system == WindowSystem::glx ? glx_library : egl_library;
  if (library.handle.load(std::memory_order_acquire) != nullptr) return &library;
  const Locked locked;
  if (library.handle.load(std::memory_order_relaxed) == nullptr && !library.failed) {
    const InsideDriver inside;  // constructors of the libraries run now
    claim_names();
    library.failed = !open_driver(system, library);
  }
  return library.failed ? nullptr : &library;
}

}  // namespace

bool driver_is_open(WindowSystem system) {
  const DriverLibrary& library = system == WindowSystem::glx ? glx_library : egl_library;
  return library.handle.load(std::memory_order_acquire) != nullptr;
}

void* real_proc_address(WindowSystem system, const char* name) {
  const DriverLibrary* library = open_library(system);
  if (library == nullptr) return nullptr;
  const InsideDriver inside;
  return library->get_proc_address(name);
}

void* real_symbol(WindowSystem system, const char* name) {
  const DriverLibrary* library = open_library(system);
  if (library == nullptr) return nullptr;
  if (void* exported = dlsym(library->handle.load(std::memory_order_relaxed), name)) return exported;
  const InsideDriver inside;
  return library->get_proc_address(name);
}

const spu::DispatchTable& driver_table(bool complete) {
  if (real_functions_filled.load(std::memory_order_acquire) && !complete) return real_functions;
  const Locked locked;
  if (real_functions_complete) return real_functions;

  // Before any window system is in use, GLX's library is as good a source as any: without a context every GL
  // call does nothing.
  if (!driver_is_open(WindowSystem::glx) && !driver_is_open(WindowSystem::egl)) {
    if (open_library(WindowSystem::glx) == nullptr) open_library(WindowSystem::egl);
  }
  for (std::size_t number = 0; number < spu::call_count; ++number) {
    const auto call = static_cast<spu::CallId>(number);
    const char* name = spu::call_name(call);
    void* function = opengl_handle != nullptr ? dlsym(opengl_handle, name) : nullptr;
    for (const WindowSystem system : {WindowSystem::glx, WindowSystem::egl}) {
      if (function == nullptr && driver_is_open(system)) function = real_proc_address(system, name);
    }
    spu::set_slot(real_functions, call, reinterpret_cast<spu::AnyFunction>(function));
  }
  real_functions_complete = complete;
  real_functions_filled.store(true, std::memory_order_release);
  return real_functions;
}

const char* own_folder() {
  return folder_of_this_library;
}

const char* own_stub(int stub) {
  return stubs.path[stub];
}

void* own_entry(const char* name) {
  static constinit std::atomic<void*> self = nullptr;
  void* handle = self.load(std::memory_order_acquire);
  if (handle == nullptr) {
    Dl_info info;
    if (dladdr(&glx_library, &info) == 0 || info.dli_fname == nullptr) return nullptr;
    handle = real_dlopen(info.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
    if (handle == nullptr) return nullptr;
    self.store(handle, std::memory_order_release);
  }
  return dlsym(handle, name);
}

void claim_names() {
  static constinit std::atomic_flag claimed{};
  if (claimed.test_and_set()) return;
  for (const auto& path : stubs.path) {
    if (path[0] != '\0') real_dlopen(path, RTLD_LAZY | RTLD_LOCAL);  // a missing stub costs a door, no more
  }
}

void reset_driver_locks_after_fork() {
  driver_lock = PTHREAD_RECURSIVE_MUTEX_INITIALIZER_NP;
}

}  // namespace understudy::interceptor
