// SPDX-License-Identifier: Apache-2.0
// Which of Highway's targets have a vector kernel. To be asked after <hwy/highway.h>, once for each target.
#pragma once

/// x86 alone: the kernels sum neighbouring products by a multiply-add, whose order Highway leaves open
/// elsewhere. From SSE4 on; Highway numbers its targets from the newest.
#define UNDERSTUDY_VECTOR_KERNEL (HWY_ARCH_X86 && HWY_TARGET <= HWY_SSE4)
