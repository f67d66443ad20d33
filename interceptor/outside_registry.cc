// SPDX-License-Identifier: Apache-2.0
// Functions that glvnd's libGL.so.1 exports although no registry lists them, from old drivers and drafts. A
// program linked with one of them must still start, and reach the real function if a driver has it.
//
// Their arguments are unknown, so each call is forwarded by a jump with all registers unchanged. The jump is
// written in x86-64 assembly; other processors do without these names.
#if defined(__x86_64__)

#include <string.h>

#include "interceptor/entry_point.h"
#include "interceptor/life_cycle.h"
#include "interceptor/real_driver.h"

// clang-format off
#define UNDERSTUDY_OUTSIDE_REGISTRY(X) \
  X(glBindANCCaptureStreamBufferNVX) \
  X(glBindTransformFeedbackEXT) \
  X(glBufferDataSysmem) \
  X(glClientWaitSyncValueuiNVX) \
  X(glColor3x) \
  X(glCompressedTexImage3DNV) \
  X(glCompressedTexSubImage3DNV) \
  X(glCopyTexSubImage3DNV) \
  X(glDebugMessageCallbackOES) \
  X(glDebugMessageControlOES) \
  X(glDebugMessageInsertOES) \
  X(glDeleteTransformFeedbacksEXT) \
  X(glDevtoolsCorrelationIdNVX) \
  X(glDevtoolsInvokeStreamedCallbackNVX) \
  X(glDrawMeshNV) \
  X(glFenceValueuiNVX) \
  X(glFramebufferTextureLayerNV) \
  X(glGenTransformFeedbacksEXT) \
  X(glGetCompressedTexImageNV) \
  X(glGetDebugMessageLogOES) \
  X(glGetNamedBufferParameteri64vEXT) \
  X(glGetObjectLabelOES) \
  X(glGetObjectPtrLabelOES) \
  X(glGetPointervOES) \
  X(glGetQueryObjectui64vNV) \
  X(glGetSyncv64NVX) \
  X(glGetTexImageNV) \
  X(glGetTexLevelParameterfvNV) \
  X(glGetTexLevelParameterivNV) \
  X(glGetVideoCaptureANCStreamivNVX) \
  X(glGpuSyncAcquireNVX) \
  X(glGpuSyncCreateNVX) \
  X(glGpuSyncDestroyNVX) \
  X(glGpuSyncReleaseNVX) \
  X(glIsTransformFeedbackEXT) \
  X(glLoadTransformEXT) \
  X(glMultTransformEXT) \
  X(glMultiTexCoord1x) \
  X(glMultiTexCoord1xv) \
  X(glMultiTexCoord2x) \
  X(glMultiTexCoord2xv) \
  X(glMultiTexCoord3x) \
  X(glMultiTexCoord3xv) \
  X(glMultiTexCoord4xv) \
  X(glNVENCInterOpFunctionNVX) \
  X(glObjectLabelOES) \
  X(glObjectPtrLabelOES) \
  X(glPatchParameterfvEXT) \
  X(glPatchParameterfvNV) \
  X(glPatchParameteriNV) \
  X(glPauseTransformFeedbackEXT) \
  X(glPopDebugGroupOES) \
  X(glPrimitiveRestart) \
  X(glPushDebugGroupOES) \
  X(glQueryCounterNV) \
  X(glResumeTransformFeedbackEXT) \
  X(glTexImage3DNV) \
  X(glTexSubImage3DNV) \
  X(glValidBackBufferHintAutodesk) \
  X(glWaitSyncValueuiNVX) \
  X(glWindowBackBufferHintAutodesk) \
  X(glXAllocateMemoryNV) \
  X(glXFreeMemoryNV) \
  X(glXGetDriverConfig) \
  X(glXGetRefreshRateSGI) \
  X(glXGetScreenDriver)
// clang-format on

namespace understudy::interceptor {

using AnyFunction = void (*)();

extern "C" {
__attribute__((visibility("hidden"))) void understudy_do_nothing();
__attribute__((visibility("hidden"))) AnyFunction understudy_outside_registry(const char* name);
}

namespace {

void* real_function(const char* name) {
  for (const WindowSystem system : {WindowSystem::glx, WindowSystem::egl, WindowSystem::osmesa}) {
    if (!driver_is_open(system)) continue;
    if (void* found = real_symbol(system, name)) return found;
  }
  return driver_is_open(WindowSystem::glx) ? nullptr : real_symbol(WindowSystem::glx, name);
}

/// Between glBegin and glEnd, where these calls are legal, pending work cannot be drawn; it waits for the
/// glEnd.
bool describes_a_vertex(const char* name) {
  return strncmp(name, "glColor3x", 9) == 0 || strncmp(name, "glMultiTexCoord", 15) == 0;
}

}  // namespace

/// Returns the target of the jump.
AnyFunction understudy_outside_registry(const char* name) {
  void* function = real_function(name);
  if (function == nullptr) {
    report_missing(name);
    return &understudy_do_nothing;
  }
  EntryThread& thread = entry_thread;
  if (thread.level == 0) {
    if (thread.state.calls != nullptr) ++*thread.state.calls;
    if (!describes_a_vertex(name)) before_frame_end(FrameEnd::wait);
  }
  return reinterpret_cast<AnyFunction>(function);
}

}  // namespace understudy::interceptor

// %r10, which no argument uses, holds the address of the name. All registers that may hold arguments are saved:
// six integer registers, the number of vector arguments (%al), and eight vector registers.
asm(R"(
    .text
    .type understudy_do_nothing, @function
    .globl understudy_do_nothing
understudy_do_nothing:
    .cfi_startproc
    endbr64
    xorl %eax, %eax
    pxor %xmm0, %xmm0
    ret
    .cfi_endproc
    .size understudy_do_nothing, .-understudy_do_nothing

    .type understudy_jump_outside_registry, @function
understudy_jump_outside_registry:
    .cfi_startproc
    pushq %rbp
    .cfi_def_cfa_offset 16
    .cfi_offset %rbp, -16
    movq %rsp, %rbp
    .cfi_def_cfa_register %rbp
    subq $192, %rsp
    movq %rdi, (%rsp)
    movq %rsi, 8(%rsp)
    movq %rdx, 16(%rsp)
    movq %rcx, 24(%rsp)
    movq %r8, 32(%rsp)
    movq %r9, 40(%rsp)
    movq %rax, 48(%rsp)
    movaps %xmm0, 64(%rsp)
    movaps %xmm1, 80(%rsp)
    movaps %xmm2, 96(%rsp)
    movaps %xmm3, 112(%rsp)
    movaps %xmm4, 128(%rsp)
    movaps %xmm5, 144(%rsp)
    movaps %xmm6, 160(%rsp)
    movaps %xmm7, 176(%rsp)
    movq %r10, %rdi
    call understudy_outside_registry
    movq %rax, %r11
    movq (%rsp), %rdi
    movq 8(%rsp), %rsi
    movq 16(%rsp), %rdx
    movq 24(%rsp), %rcx
    movq 32(%rsp), %r8
    movq 40(%rsp), %r9
    movq 48(%rsp), %rax
    movaps 64(%rsp), %xmm0
    movaps 80(%rsp), %xmm1
    movaps 96(%rsp), %xmm2
    movaps 112(%rsp), %xmm3
    movaps 128(%rsp), %xmm4
    movaps 144(%rsp), %xmm5
    movaps 160(%rsp), %xmm6
    movaps 176(%rsp), %xmm7
    leave
    .cfi_def_cfa %rsp, 8
    jmp *%r11
    .cfi_endproc
    .size understudy_jump_outside_registry, .-understudy_jump_outside_registry
)");

#define UNDERSTUDY_JUMP(name)                      \
  asm("    .section .rodata\n"                     \
      "1:  .string \"" #name                       \
      "\"\n"                                       \
      "    .text\n"                                \
      "    .globl " #name                          \
      "\n"                                         \
      "    .type " #name ", @function\n" #name     \
      ":\n"                                        \
      "    .cfi_startproc\n"                       \
      "    endbr64\n"                              \
      "    leaq 1b(%rip), %r10\n"                  \
      "    jmp understudy_jump_outside_registry\n" \
      "    .cfi_endproc\n"                         \
      "    .size " #name ", .-" #name "\n");
UNDERSTUDY_OUTSIDE_REGISTRY(UNDERSTUDY_JUMP)
#undef UNDERSTUDY_JUMP

#endif
