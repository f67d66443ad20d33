// Streams that nobody wrote: whatever the bytes say, nothing may crash, hang or take memory without measure.
#include "tests/fuzz/played_input.h"
#include "tests/spu/stream/stateful_driver.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace understudy::spu::testing;
  StatefulDriver driver;
  driver.counts_only = true;
  // Half of the inputs meet a driver with buffers bound, so that offsets pass.
  if (size % 2 == 1) {
    for (const GLenum binding :
         {GL_ARRAY_BUFFER_BINDING, GL_ELEMENT_ARRAY_BUFFER_BINDING, GL_PIXEL_UNPACK_BUFFER_BINDING,
          GL_PIXEL_PACK_BUFFER_BINDING, GL_DRAW_INDIRECT_BUFFER_BINDING}) {
      driver.set(binding, 1);
    }
  }
  play_input(std::as_bytes(std::span(data, size)), driver.table());
  return 0;
}
