// SPDX-License-Identifier: Apache-2.0
// Arbitrary messages between an application and a GL server: they must not cause a crash, a hang or excessive
// memory.
#include "tests/fuzz/remote_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  understudy::spu::testing::play_gl_server_input(std::as_bytes(std::span(data, size)));
  return 0;
}
