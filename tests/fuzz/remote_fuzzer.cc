// SPDX-License-Identifier: Apache-2.0
// Bytes that nobody sent, over TCP: nothing may crash, hang or take memory without measure.
#include "tests/fuzz/remote_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  understudy::spu::testing::play_remote_input(std::as_bytes(std::span(data, size)));
  return 0;
}
