// Bytes that nobody sent, over TCP: nothing may crash, hang or take memory without measure.
#include "tests/fuzz/link_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  understudy::spu::testing::play_link_input(std::as_bytes(std::span(data, size)));
  return 0;
}
