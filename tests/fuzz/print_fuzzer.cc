// SPDX-License-Identifier: Apache-2.0
// Arbitrary streams, printed as text.
#include <memory>
#include <span>

#include "spu/print/record_text.h"
#include "tests/fuzz/played_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace understudy::spu;
  testing::walk_input(std::as_bytes(std::span(data, size)), [](auto words, auto payload) {
    RecordText text([](std::string_view) {}, {});
    for (std::size_t at = 0; at < words.size();) {
      const auto record = record_at(words, at, payload);
      if (!record) break;
      text.tell(*record);
      at += record->words.size();
    }
    text.finish();
  });
  return 0;
}
