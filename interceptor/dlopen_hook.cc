// SPDX-License-Identifier: Apache-2.0
// The dlopen hook of LD_PRELOAD: applications that open OpenGL by name get the stub instead.
//
// glibc inspects the caller of dlopen (its RUNPATH, its namespace), so requests that are not for a stub are
// forwarded by a jump that leaves the caller's return address on the stack. On x86-64 the jump is written in
// assembly. Elsewhere the compiler turns the tail call into a jump if it optimises; if it does not, the plain
// call loses the caller's RUNPATH.
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
/// Target of the jump below.
__attribute__((visibility("hidden"))) constinit Dlopen understudy_next_dlopen = nullptr;

/// The arguments for the next dlopen, returned in two registers.
struct Request {
  const char* name;
  long mode;
};
__attribute__((visibility("hidden"))) Request understudy_route_dlopen(const char* name, int mode,
                                                                      const void* caller);
}

namespace {

/// The C library's own dlopen. Our search for the driver must bypass other hooks of the process that redirect
/// OpenGL: apitrace substitutes itself for every OpenGL library, so it would become our driver while we are its
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

/// The dlopen that the application's requests are forwarded to.
Dlopen next_dlopen() {
  if (understudy_next_dlopen == nullptr) {
    // If preloaded, this library precedes the C library; loaded as a dependency of a stub, it follows it.
    void* next = dlsym(RTLD_NEXT, "dlopen");
    understudy_next_dlopen = next != nullptr ? reinterpret_cast<Dlopen>(next) : libc_dlopen();
  }
  return understudy_next_dlopen;
}

/// Whether the stub replaces `name`. OSMesa's does so only if OSMesa is installed. A program that checks
/// whether OSMesa is loaded (RTLD_NOLOAD) asks about the real library; if that is loaded, the program gets our
/// stub.
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
    // With RTLD_DEEPBIND a plugin would prefer the OpenGL library that it was linked with.
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
