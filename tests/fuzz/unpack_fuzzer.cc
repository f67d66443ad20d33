// SPDX-License-Identifier: Apache-2.0
// Streams that nobody wrote, above a driver that reads and writes every argument to its extent: whatever the
// bytes say, nothing may be read or written that is not there, hang, or take memory without measure.
#include "tests/fuzz/played_input.h"
#include "tests/spu/stream/reading_driver.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace understudy::spu::testing;
  play_input<ReadingDriver>(std::as_bytes(std::span(data, size)));
  return 0;
}
