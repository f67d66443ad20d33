// SPDX-License-Identifier: Apache-2.0
// Preloaded library that makes one call of Understudy fail, once per process.
//
//   FAIL_WHAT=memory   malloc, calloc, realloc, posix_memalign, aligned_alloc and operator new
//   FAIL_WHAT=system   system calls: files, mappings, sockets, threads
//   FAIL_NTH=N         the Nth such call of the process fails, counted from 0
//   FAIL_COUNT=FILE    receives the number of such calls as 8 bytes, however the process ends
//
// A call is Understudy's if it is made by the core or the entry library, or on their behalf by a library for C,
// C++, tasks, text or compression. Calls of the driver and of the program itself do not fail. Neither does the
// start of oneTBB's threads: if a thread cannot be started, the exception leaves a lock in
// tbb::detail::r1::spawn locked, which no caller can repair (compositor/service/worker_threads.h checks
// beforehand whether threads can be started).
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <poll.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>
#include <unwind.h>

#include <atomic>
#include <cstdint>
#include <new>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

enum class Owner { nobody, understudy, library };
enum class Kind { memory, system };

thread_local bool inside = false;

/// While one exists, calls are this library's own and do not count as Understudy's.
class Inside {
 public:
  Inside() { inside = true; }
  ~Inside() { inside = before_; }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

 private:
  const bool before_ = inside;
};

bool is_named(const char* path, const char* name) {
  const char* const last = strrchr(path, '/');
  return strncmp(last != nullptr ? last + 1 : path, name, strlen(name)) == 0;
}

Owner owner_by_name(const char* path) {
  for (const char* name : {"libunderstudy-core", "libunderstudy.so"})
    if (is_named(path, name)) return Owner::understudy;
  for (const char* name :
       {"libstdc++", "libc.so", "libfmt", "libtbb", "libzstd", "libsodium", "libfailing", "ld-linux"})
    if (is_named(path, name)) return Owner::library;
  return Owner::nobody;
}

Owner owner_of(const void* address) {
  dl_find_object found;
  if (_dl_find_object(const_cast<void*>(address), &found) != 0 || found.dlfo_link_map->l_name == nullptr)
    return Owner::nobody;
  // Caches the last results: almost all calls come from the same few libraries.
  struct Known {
    const void* map;
    Owner owner;
  };
  static thread_local Known known[8];
  Known& here = known[(reinterpret_cast<std::uintptr_t>(found.dlfo_link_map) >> 6) % 8];
  if (here.map != found.dlfo_link_map) here = {found.dlfo_link_map, owner_by_name(found.dlfo_link_map->l_name)};
  return here.owner;
}

bool is_tbb(const void* address) {
  dl_find_object found;
  return _dl_find_object(const_cast<void*>(address), &found) == 0 && found.dlfo_link_map->l_name != nullptr &&
         is_named(found.dlfo_link_map->l_name, "libtbb");
}

_Unwind_Reason_Code look_at_frame(_Unwind_Context* context, void* answer) {
  const Owner owner = owner_of(reinterpret_cast<const void*>(_Unwind_GetIP(context)));
  if (owner == Owner::library) return _URC_NO_REASON;
  *static_cast<Owner*>(answer) = owner;
  return _URC_END_OF_STACK;
}

bool is_understudys(const void* caller) {
  const Owner owner = owner_of(caller);
  if (owner != Owner::library) return owner == Owner::understudy;
  Owner first = Owner::nobody;
  _Unwind_Backtrace(&look_at_frame, &first);
  return first == Owner::understudy;
}

using Count = std::atomic<long>;

struct Plan {
  bool counts = false;
  Kind kind = Kind::memory;
  long nth = -1;
  Count* calls = nullptr;
};

Count calls_unless_kept = 0;

/// The counter is mapped from the file, so that it survives when the process is killed.
Count* kept_count(const char* path) {
  const int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  void* const memory = file >= 0 && ftruncate(file, sizeof(Count)) == 0
                           ? mmap(nullptr, sizeof(Count), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                           : MAP_FAILED;
  if (file >= 0) close(file);
  return memory != MAP_FAILED ? static_cast<Count*>(memory) : &calls_unless_kept;
}

Plan plan_of_environment() {
  Plan plan;
  const char* const what = getenv("FAIL_WHAT");
  if (what == nullptr) return plan;
  plan.counts = true;
  plan.kind = strcmp(what, "system") == 0 ? Kind::system : Kind::memory;
  if (const char* const nth = getenv("FAIL_NTH")) plan.nth = atol(nth);
  const char* const path = getenv("FAIL_COUNT");
  plan.calls = path != nullptr ? kept_count(path) : &calls_unless_kept;
  return plan;
}

const Plan& plan() {
  static const Plan plan = plan_of_environment();
  return plan;
}

bool fails(Kind kind, const void* caller) {
  if (inside) return false;
  const Inside now;
  if (!plan().counts || plan().kind != kind || !is_understudys(caller)) return false;
  if (plan().calls->fetch_add(1, std::memory_order_relaxed) != plan().nth) return false;
  constexpr char said[] = "A CALL FAILS\n";
  // Not write(), which looks up the C library's function with dlsym() at its first use: dlsym() frees the state
  // of dlerror(), and dlerror() may be the function that requested the memory.
  (void)!syscall(SYS_write, 2, said, sizeof said - 1);
  // For debugging: shows where the call fails.
  if (getenv("FAIL_ABORT") != nullptr) abort();
  return true;
}

template <class Function>
Function next(const char* name) {
  const Inside now;
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

void* allocated(std::size_t size, const void* caller) {
  if (fails(Kind::memory, caller)) throw std::bad_alloc();
  void* const memory = __libc_malloc(size != 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void* allocated(std::size_t size, std::align_val_t alignment, const void* caller) {
  if (fails(Kind::memory, caller)) throw std::bad_alloc();
  void* const memory = __libc_memalign(std::size_t(alignment), size != 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

#define CALLER __builtin_return_address(0)

void* operator new(std::size_t size) {
  return allocated(size, CALLER);
}
void* operator new[](std::size_t size) {
  return allocated(size, CALLER);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocated(size, alignment, CALLER);
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return allocated(size, alignment, CALLER);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return fails(Kind::memory, CALLER) ? nullptr : __libc_malloc(size != 0 ? size : 1);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return fails(Kind::memory, CALLER) ? nullptr : __libc_malloc(size != 0 ? size : 1);
}
void operator delete(void* memory) noexcept {
  free(memory);
}
void operator delete[](void* memory) noexcept {
  free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  free(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  free(memory);
}

extern "C" {

void* malloc(std::size_t size) {
  if (!fails(Kind::memory, CALLER)) return __libc_malloc(size);
  errno = ENOMEM;
  return nullptr;
}

void* calloc(std::size_t count, std::size_t size) {
  if (!fails(Kind::memory, CALLER)) return __libc_calloc(count, size);
  errno = ENOMEM;
  return nullptr;
}

void* realloc(void* memory, std::size_t size) {
  if (!fails(Kind::memory, CALLER)) return __libc_realloc(memory, size);
  errno = ENOMEM;
  return nullptr;
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  if (fails(Kind::memory, CALLER)) return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory != nullptr ? 0 : ENOMEM;
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  if (!fails(Kind::memory, CALLER)) return __libc_memalign(alignment, size);
  errno = ENOMEM;
  return nullptr;
}

/// A function of the C library that fails by returning `failure` and setting `error`.
#define SYSTEM_CALL(result, name, parameters, arguments, failure, error)       \
  result name parameters {                                                     \
    static result(*const real) parameters = next<result(*) parameters>(#name); \
    if (!fails(Kind::system, CALLER)) return real arguments;                   \
    errno = error;                                                             \
    return failure;                                                            \
  }

SYSTEM_CALL(ssize_t, read, (int file, void* bytes, std::size_t size), (file, bytes, size), -1, EIO)
SYSTEM_CALL(ssize_t, write, (int file, const void* bytes, std::size_t size), (file, bytes, size), -1, ENOSPC)
SYSTEM_CALL(ssize_t, pread, (int file, void* bytes, std::size_t size, off_t at), (file, bytes, size, at), -1,
            EIO)
SYSTEM_CALL(ssize_t, pread64, (int file, void* bytes, std::size_t size, off64_t at), (file, bytes, size, at),
            -1, EIO)
SYSTEM_CALL(ssize_t, pwrite, (int file, const void* bytes, std::size_t size, off_t at), (file, bytes, size, at),
            -1, ENOSPC)
SYSTEM_CALL(ssize_t, pwrite64, (int file, const void* bytes, std::size_t size, off64_t at),
            (file, bytes, size, at), -1, ENOSPC)
SYSTEM_CALL(ssize_t, readv, (int file, const iovec* parts, int count), (file, parts, count), -1, EIO)
SYSTEM_CALL(ssize_t, writev, (int file, const iovec* parts, int count), (file, parts, count), -1, ENOSPC)
SYSTEM_CALL(void*, mmap, (void* at, std::size_t size, int protection, int flags, int file, off_t from),
            (at, size, protection, flags, file, from), MAP_FAILED, ENOMEM)
SYSTEM_CALL(void*, mmap64, (void* at, std::size_t size, int protection, int flags, int file, off64_t from),
            (at, size, protection, flags, file, from), MAP_FAILED, ENOMEM)
SYSTEM_CALL(int, socket, (int domain, int type, int protocol) noexcept, (domain, type, protocol), -1, EMFILE)
SYSTEM_CALL(int, connect, (int file, const sockaddr* address, socklen_t size), (file, address, size), -1,
            ECONNREFUSED)
SYSTEM_CALL(ssize_t, send, (int file, const void* bytes, std::size_t size, int flags),
            (file, bytes, size, flags), -1, EPIPE)
SYSTEM_CALL(ssize_t, sendmsg, (int file, const msghdr* message, int flags), (file, message, flags), -1, EPIPE)
SYSTEM_CALL(ssize_t, recv, (int file, void* bytes, std::size_t size, int flags), (file, bytes, size, flags), -1,
            ECONNRESET)
SYSTEM_CALL(ssize_t, recvmsg, (int file, msghdr* message, int flags), (file, message, flags), -1, ECONNRESET)
SYSTEM_CALL(int, poll, (pollfd * files, nfds_t count, int milliseconds), (files, count, milliseconds), -1,
            ENOMEM)
SYSTEM_CALL(int, memfd_create, (const char* name, unsigned flags) noexcept, (name, flags), -1, EMFILE)
SYSTEM_CALL(int, ftruncate, (int file, off_t size) noexcept, (file, size), -1, ENOSPC)
SYSTEM_CALL(int, ftruncate64, (int file, off64_t size) noexcept, (file, size), -1, ENOSPC)
SYSTEM_CALL(int, fallocate, (int file, int mode, off_t from, off_t size), (file, mode, from, size), -1, ENOSPC)
SYSTEM_CALL(int, fallocate64, (int file, int mode, off64_t from, off64_t size), (file, mode, from, size), -1,
            ENOSPC)
SYSTEM_CALL(int, posix_fallocate, (int file, off_t from, off_t size), (file, from, size), ENOSPC, ENOSPC)
SYSTEM_CALL(int, posix_fallocate64, (int file, off64_t from, off64_t size), (file, from, size), ENOSPC, ENOSPC)
SYSTEM_CALL(int, eventfd, (unsigned value, int flags) noexcept, (value, flags), -1, EMFILE)
SYSTEM_CALL(FILE*, fopen, (const char* path, const char* mode), (path, mode), nullptr, EMFILE)
SYSTEM_CALL(FILE*, fopen64, (const char* path, const char* mode), (path, mode), nullptr, EMFILE)
int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*body)(void*),
                   void* argument) noexcept {
  static int (*const real)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*) =
      next<decltype(real)>("pthread_create");
  if (is_tbb(CALLER) || !fails(Kind::system, CALLER)) return real(thread, attributes, body, argument);
  return EAGAIN;
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const unsigned mode = va_arg(rest, unsigned);
  va_end(rest);
  static int (*const real)(const char*, int, ...) = next<int (*)(const char*, int, ...)>("open");
  if (!fails(Kind::system, CALLER)) return real(path, flags, mode);
  errno = EMFILE;
  return -1;
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const unsigned mode = va_arg(rest, unsigned);
  va_end(rest);
  static int (*const real)(const char*, int, ...) = next<int (*)(const char*, int, ...)>("open64");
  if (!fails(Kind::system, CALLER)) return real(path, flags, mode);
  errno = EMFILE;
  return -1;
}

}  // extern "C"
