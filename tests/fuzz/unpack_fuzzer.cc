// SPDX-License-Identifier: Apache-2.0
// Arbitrary streams above a driver that reads and writes every argument to its full extent: they must not cause
// invalid reads or writes, a hang or excessive memory.
#include "tests/fuzz/played_input.h"
#include "tests/spu/stream/reading_driver.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace understudy::spu::testing;
  play_input<ReadingDriver>(std::as_bytes(std::span(data, size)));
  return 0;
}
