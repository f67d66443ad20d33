// SPDX-License-Identifier: Apache-2.0
// Selects the Highway targets that have a vector kernel. Evaluate after <hwy/highway.h>, once per target.
#pragma once

/// x86 only, because the kernels sum neighbouring products by a multiply-add whose order Highway leaves
/// undefined on other architectures. From SSE4 on; Highway numbers its targets from the newest.
#define UNDERSTUDY_VECTOR_KERNEL (HWY_ARCH_X86 && HWY_TARGET <= HWY_SSE4)
