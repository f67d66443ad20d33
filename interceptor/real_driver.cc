// SPDX-License-Identifier: Apache-2.0
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
#include "interceptor/entry_thread.h"
#include "interceptor/gl_names.h"
#include "interceptor/log_line.h"
#include "interceptor/osmesa.h"
#include "interceptor/remote.h"

namespace understudy::interceptor {
namespace {

using GetProcAddress = void* (*)(const char*);

struct DriverLibrary {
  WindowSystem system;
  const char* file;
  const char* file_without_glvnd;  ///< null: none
  const char* lookup;              ///< the function that looks up the others
  std::atomic<void*> handle = nullptr;
  GetProcAddress get_proc_address = nullptr;
  bool failed = false;  ///< searched for and not found: not searched for again
};

constinit DriverLibrary libraries[] = {
    {WindowSystem::glx, "libGLX.so.0", "libGL.so.1", "glXGetProcAddressARB"},
    {WindowSystem::egl, "libEGL.so.1", nullptr, "eglGetProcAddress"},
    {WindowSystem::osmesa, "libOSMesa.so.8", nullptr, "OSMesaGetProcAddress"},
};
constinit void* opengl_handle = nullptr;  ///< libOpenGL.so.0, or libGL.so.1 where there is no glvnd

DriverLibrary& library_of(WindowSystem system) {
  return libraries[static_cast<int>(system)];
}

/// The GL functions of a driver, looked up when first needed.
struct DriverFunctions {
  spu::DispatchTable table{};
  std::atomic<bool> filled = false;
  bool complete = false;  ///< filled while a context was current: some drivers return addresses only then
};

constinit DriverFunctions glvnd_functions;  ///< of GLX and EGL
constinit DriverFunctions osmesa_functions;
constinit pthread_mutex_t driver_lock = PTHREAD_RECURSIVE_MUTEX_INITIALIZER_NP;

constinit char folder_of_this_library[PATH_MAX] = {};
constinit StubPaths stubs{};

/// Runs while the library is loaded: a relative LD_PRELOAD path becomes invalid when the program changes its
/// working directory.
__attribute__((constructor)) void find_own_folder() {
  Dl_info info;
  if (dladdr(&libraries, &info) == 0 || info.dli_fname == nullptr) return;
  if (realpath(info.dli_fname, folder_of_this_library) == nullptr) return;
  if (char* slash = strrchr(folder_of_this_library, '/')) *slash = '\0';
  char entry[PATH_MAX];
  const int length = snprintf(entry, sizeof entry, "%s/entry", folder_of_this_library);
  if (length > 0 && length < static_cast<int>(sizeof entry)) stubs.set_folder(entry);
}

class Locked {
 public:
  Locked() { pthread_mutex_lock(&driver_lock); }
  ~Locked() { pthread_mutex_unlock(&driver_lock); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;
};

/// Writes the path of NAME in FOLDER; false if there is no such file. The spelling FOLDER/./NAME prevents glibc
/// from using the real library for a later request by the usual absolute path: such a request must still reach
/// the auditor.
bool find_in(const char* folder, const char* name, char (&path)[PATH_MAX]) {
  const int length = snprintf(path, sizeof path, "%s/./%s", folder, name);
  return length >= 0 && length < static_cast<int>(sizeof path) && access(path, R_OK) == 0;
}

void* open_in(const char* folder, const char* name) {
  char path[PATH_MAX];
  return find_in(folder, name, path) ? real_dlopen(path, RTLD_LAZY | RTLD_LOCAL) : nullptr;
}

/// Opens the library from `folder` if it is there and is not one of ours.
bool open_from(const char* folder, DriverLibrary& library) {
  char path[PATH_MAX];
  void* handle = open_in(folder, library.file);
  // If the folder has glvnd's library but it could not be opened, libGL.so.1 there is glvnd's too, and its
  // functions would call ours.
  const bool classic =
      handle == nullptr && library.file_without_glvnd != nullptr && !find_in(folder, library.file, path);
  if (classic) handle = open_in(folder, library.file_without_glvnd);
  if (handle == nullptr) return false;

  void* const found = dlsym(handle, library.lookup);
  if (found == nullptr || found == own_entry(library.lookup)) return false;  // one of our stubs: search further

  library.get_proc_address = reinterpret_cast<GetProcAddress>(found);
  if (opengl_handle == nullptr && library.system != WindowSystem::osmesa) {
    opengl_handle = classic ? handle : open_in(folder, "libOpenGL.so.0");
  }
  library.handle.store(handle, std::memory_order_release);
  log_line(logging::Level::debug, "OpenGL driver: %s/%s", folder,
           classic ? library.file_without_glvnd : library.file);
  return true;
}

/// The folder of the C library, which always matches the architecture of this process.
bool libc_folder(char (&folder)[PATH_MAX]) {
  Dl_info info;
  if (dladdr(reinterpret_cast<void*>(&secure_getenv), &info) == 0 || info.dli_fname == nullptr) return false;
  const char* slash = strrchr(info.dli_fname, '/');
  if (slash == nullptr || slash - info.dli_fname >= PATH_MAX) return false;
  memcpy(folder, info.dli_fname, static_cast<std::size_t>(slash - info.dli_fname));
  folder[slash - info.dli_fname] = '\0';
  return true;
}

/// Searches the folders of the loader's own search path: LD_LIBRARY_PATH and the program's RPATH come first, so
/// that a driver which the user provided for the application is found.
bool open_from_search_path(DriverLibrary& library) {
  void* program = real_dlopen(nullptr, RTLD_LAZY);
  Dl_serinfo size;
  if (program == nullptr || dlinfo(program, RTLD_DI_SERINFOSIZE, &size) != 0) return false;
  auto* folders = static_cast<Dl_serinfo*>(malloc(size.dls_size));
  if (folders == nullptr) return false;
  bool opened = false;
  if (dlinfo(program, RTLD_DI_SERINFOSIZE, folders) == 0 && dlinfo(program, RTLD_DI_SERINFO, folders) == 0) {
    for (unsigned i = 0; i < folders->dls_cnt && !opened; ++i) {
      opened = open_from(folders->dls_serpath[i].dls_name, library);
    }
  }
  free(folders);
  return opened;
}

/// True if the contexts of GLX and EGL belong to a GL server instead of this machine's driver.
bool is_elsewhere(WindowSystem system) {
  return system != WindowSystem::osmesa && is_remote();
}

/// The table of a thread without a driver: every call does nothing.
constinit const spu::DispatchTable no_functions{};

enum class Failure { said, silent };

bool open_driver(DriverLibrary& library, Failure failure) {
  const char* const or_classic = library.file_without_glvnd != nullptr ? " or libGL.so.1" : "";
  if (const char* folder = secure_getenv("UNDERSTUDY_DRIVER_DIR"); folder != nullptr && *folder != '\0') {
    if (open_from(folder, library)) return true;
    // A folder for a driver of GLX or EGL need not have an OSMesa too.
    if (library.system != WindowSystem::osmesa) {
      log_line(logging::Level::warn,
               "UNDERSTUDY_DRIVER_DIR=%s holds no %s%s that can be opened and is not Understudy's own; looking "
               "in the system's folders",
               folder, library.file, or_classic);
    }
  }
  if (open_from_search_path(library)) return true;
  char folder[PATH_MAX];
  if (libc_folder(folder) && open_from(folder, library)) return true;
  for (const char* usual : {"/usr/lib/x86_64-linux-gnu", "/usr/lib64", "/usr/lib", "/lib64"}) {
    if (open_from(usual, library)) return true;
  }
  if (failure == Failure::said) {
    log_line(logging::Level::error,
             "no OpenGL driver found: no %s%s in UNDERSTUDY_DRIVER_DIR, LD_LIBRARY_PATH or the system's "
             "library folders; set UNDERSTUDY_DRIVER_DIR to the folder that holds it",
             library.file, or_classic);
  }
  return false;
}

/// Returns null if the driver cannot be opened; logs that once.
DriverLibrary* open_library(WindowSystem system, Failure failure = Failure::said) {
  DriverLibrary& library = library_of(system);
  if (library.handle.load(std::memory_order_acquire) != nullptr) return &library;
  const Locked locked;
  if (library.handle.load(std::memory_order_relaxed) == nullptr && !library.failed) {
    const InsideDriver inside;  // constructors of the libraries run now
    claim_names();
    const bool opened = open_driver(library, failure);
    if (!opened && failure == Failure::silent) return nullptr;
    library.failed = !opened;
  }
  return library.failed ? nullptr : &library;
}

void* osmesa_function(const char* name) {
  void* exported = dlsym(library_of(WindowSystem::osmesa).handle.load(std::memory_order_relaxed), name);
  return exported != nullptr ? exported : real_proc_address(WindowSystem::osmesa, name);
}

void* glvnd_function(const char* name) {
  void* function = opengl_handle != nullptr ? dlsym(opengl_handle, name) : nullptr;
  for (const WindowSystem system : {WindowSystem::glx, WindowSystem::egl}) {
    if (function == nullptr && driver_is_open(system)) function = real_proc_address(system, name);
  }
  return function;
}

const spu::DispatchTable& filled(DriverFunctions& functions, void* (*look_up)(const char*), bool complete) {
  if (functions.filled.load(std::memory_order_acquire) && !complete) return functions.table;
  const Locked locked;
  if (functions.complete) return functions.table;
  for (std::size_t number = 0; number < spu::call_count; ++number) {
    const auto call = static_cast<spu::CallId>(number);
    if (spu::slot(functions.table, call) != nullptr) continue;  // another thread may be calling it
    spu::set_slot(functions.table, call, reinterpret_cast<spu::AnyFunction>(look_up(spu::call_name(call))));
  }
  if (look_up == &osmesa_function) end_frames_of_osmesa(functions.table);
  functions.complete = complete;
  functions.filled.store(true, std::memory_order_release);
  return functions.table;
}

}  // namespace

bool driver_is_open(WindowSystem system) {
  if (is_elsewhere(system)) return true;
  return library_of(system).handle.load(std::memory_order_acquire) != nullptr;
}

bool driver_is_there(WindowSystem system) {
  if (is_elsewhere(system)) return true;
  return open_library(system, Failure::silent) != nullptr;
}

void* real_proc_address(WindowSystem system, const char* name) {
  if (is_elsewhere(system)) return remote_symbol(system, name);
  const DriverLibrary* library = open_library(system);
  if (library == nullptr) return nullptr;
  const InsideDriver inside;
  return library->get_proc_address(name);
}

void* real_symbol(WindowSystem system, const char* name) {
  if (is_elsewhere(system)) return remote_symbol(system, name);
  const DriverLibrary* library = open_library(system);
  if (library == nullptr) return nullptr;
  if (void* exported = dlsym(library->handle.load(std::memory_order_relaxed), name)) return exported;
  const InsideDriver inside;
  return library->get_proc_address(name);
}

const spu::DispatchTable& driver_table(WindowSystem system) {
  if (is_elsewhere(system)) return no_functions;
  const bool osmesa = system == WindowSystem::osmesa;
  return filled(osmesa ? osmesa_functions : glvnd_functions, osmesa ? &osmesa_function : &glvnd_function,
                /*complete=*/true);
}

const spu::DispatchTable& driver_table_without_context() {
  if (is_remote()) return no_functions;
  if (!driver_is_open(WindowSystem::glx) && !driver_is_open(WindowSystem::egl)) {
    if (driver_is_open(WindowSystem::osmesa)) return filled(osmesa_functions, &osmesa_function, false);
    // GLX's library serves as well as any: without a context every GL call does nothing.
    if (open_library(WindowSystem::glx) == nullptr) open_library(WindowSystem::egl);
  }
  return filled(glvnd_functions, &glvnd_function, false);
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
    if (dladdr(&libraries, &info) == 0 || info.dli_fname == nullptr) return nullptr;
    handle = real_dlopen(info.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
    if (handle == nullptr) return nullptr;
    self.store(handle, std::memory_order_release);
  }
  return dlsym(handle, name);
}

void claim_names() {
  static constinit std::atomic_flag claimed{};
  if (claimed.test_and_set()) return;
  for (int stub = 0; stub < stub_count; ++stub) {
    if (stub == osmesa_stub || stubs.path[stub][0] == '\0') continue;
    real_dlopen(stubs.path[stub], RTLD_LAZY | RTLD_LOCAL);  // a missing stub only leaves its own name unclaimed
  }
}

void reset_driver_locks_after_fork() {
  driver_lock = PTHREAD_RECURSIVE_MUTEX_INITIALIZER_NP;
}

}  // namespace understudy::interceptor
