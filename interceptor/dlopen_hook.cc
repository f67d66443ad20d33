// SPDX-License-Identifier: Apache-2.0
// LD_PRELOAD's second half: applications that open OpenGL by name get the stub instead.
//
// glibc looks at who called dlopen (the caller's RUNPATH, its namespace), so every request that is not ours is
// passed on by a jump, with the caller's return address still on the stack. On x86-64 that jump is written
// down; elsewhere the compiler makes one of a call in tail position when it optimises, and a plain call, which
// loses the caller's RUNPATH, when it does not.
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <atomic>

#include "interceptor/entry_point.h"
#include "interceptor/gl_names.h"
#include "interceptor/real_driver.h"

namespace understudy::interceptor {

using Dlopen = void* (*)(const char*, int);

extern "C" {
/// Read by the jump below.
__attribute__((visibility("hidden"))) constinit Dlopen understudy_next_dlopen = nullptr;

/// What to ask of the next dlopen: returned in two registers.
struct Request {
  const char* name;
  long mode;
};
__attribute__((visibility("hidden"))) Request understudy_route_dlopen(const char* name, int mode,
                                                                      const void* caller);
}

namespace {

/// The C library's own. Whoever else stands in the process and changes what is opened (apitrace gives itself
/// for every OpenGL) must not see us look for the driver: it would become the driver of which we are its
/// driver.
Dlopen libc_dlopen() {
  static constinit std::atomic<Dlopen> found = nullptr;
  Dlopen function = found.load(std::memory_order_relaxed);
  if (function != nullptr) return function;
  void* libc = dlmopen(LM_ID_BASE, "libc.so.6", RTLD_LAZY | RTLD_NOLOAD);
  void* symbol = libc != nullptr ? dlsym(libc, "dlopen") : nullptr;
  if (symbol == nullptr) symbol = dlsym(RTLD_DEFAULT, "dlopen");  // before glibc 2.34 it was libdl's
  function = reinterpret_cast<Dlopen>(symbol);
  found.store(function, std::memory_order_relaxed);
  return function;
}

/// Where the application's requests go on to.
Dlopen next_dlopen() {
  if (understudy_next_dlopen == nullptr) {
    // Preloaded, we stand before the C library; as what a stub needs, behind it.
    void* next = dlsym(RTLD_NEXT, "dlopen");
    understudy_next_dlopen = next != nullptr ? reinterpret_cast<Dlopen>(next) : libc_dlopen();
  }
  return understudy_next_dlopen;
}

/// Is `name` to be answered by that stub? OSMesa's stands only where there is an OSMesa. A program that asks
/// whether OSMesa is loaded (RTLD_NOLOAD) means the library, not our stub, which it then gets all the same.
bool stub_answers(int stub, const char* name, int& mode) {
  if (stub < 0 || own_stub(stub)[0] == '\0') return false;
  if (stub != osmesa_stub) return true;
  if (strchr(name, '/') != nullptr && access(name, R_OK) != 0) return false;
  if ((mode & RTLD_NOLOAD) == 0) return driver_is_there(WindowSystem::osmesa);
  void* loaded = real_dlopen(name, RTLD_LAZY | RTLD_NOLOAD);
  if (loaded == nullptr) return false;
  dlclose(loaded);
  mode &= ~RTLD_NOLOAD;
  return true;
}

bool caller_may_have_the_real_one(const void* caller) {
  Dl_info info;
  return dladdr(caller, &info) != 0 && info.dli_fname != nullptr &&
         may_have_the_real_one(info.dli_fname, secure_getenv("UNDERSTUDY_DRIVER_DIR"));
}

}  // namespace

void* real_dlopen(const char* name, int mode) {
  return libc_dlopen()(name, mode);
}

Request understudy_route_dlopen(const char* name, int mode, const void* caller) {
  next_dlopen();
  if (name == nullptr) return {name, mode};
  claim_names();
  const int stub = stub_for(name);
  const bool deep = (mode & RTLD_DEEPBIND) != 0;
  if ((stub >= 0 || deep) && !caller_may_have_the_real_one(caller)) {
    if (stub_answers(stub, name, mode)) name = own_stub(stub);
    // RTLD_DEEPBIND would make a plugin prefer the OpenGL that it was linked with to us.
    mode &= ~RTLD_DEEPBIND;
  }
  return {name, mode};
}

}  // namespace understudy::interceptor

#if defined(__x86_64__)
asm(R"(
    .text
    .globl dlopen
    .type dlopen, @function
dlopen:
    .cfi_startproc
    endbr64
    movq (%rsp), %rdx
    subq $8, %rsp
    .cfi_adjust_cfa_offset 8
    call understudy_route_dlopen
    addq $8, %rsp
    .cfi_adjust_cfa_offset -8
    movq %rax, %rdi
    movl %edx, %esi
    movq understudy_next_dlopen(%rip), %rax
    jmp *%rax
    .cfi_endproc
    .size dlopen, .-dlopen
)");
#else
namespace understudy::interceptor {
UNDERSTUDY_ENTRY void* dlopen(const char* name, int mode) {
  const Request request = understudy_route_dlopen(name, mode, __builtin_return_address(0));
  return understudy_next_dlopen(request.name, static_cast<int>(request.mode));
}
}  // namespace understudy::interceptor
#endif
