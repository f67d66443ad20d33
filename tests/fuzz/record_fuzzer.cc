// SPDX-License-Identifier: Apache-2.0
// Records that nobody sealed, and messages in records of any length: nothing may crash, hang or take memory
// without measure.
#include "tests/fuzz/record_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  understudy::spu::testing::open_records(input);
  understudy::spu::testing::seal_and_open(input);
  return 0;
}
