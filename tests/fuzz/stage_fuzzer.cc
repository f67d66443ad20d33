// What neither an application nor a stage would say: nothing may crash, hang or take memory without measure.
#include "tests/fuzz/link_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  understudy::spu::testing::play_stage_input(std::as_bytes(std::span(data, size)));
  return 0;
}
