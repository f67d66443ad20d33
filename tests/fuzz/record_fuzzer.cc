// SPDX-License-Identifier: Apache-2.0
// Arbitrary encrypted records, and messages in records of any length: they must not cause a crash, a hang or
// excessive memory.
#include "tests/fuzz/record_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  understudy::spu::testing::open_records(input);
  understudy::spu::testing::seal_and_open(input);
  return 0;
}
