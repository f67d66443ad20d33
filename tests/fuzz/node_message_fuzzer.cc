// SPDX-License-Identifier: Apache-2.0
// Arbitrary messages between applications, launchers and nodes. Each is refused with MalformedMessage, or its
// decoded form can be encoded and decoded again without a change.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "tests/compositor/message_kinds.h"

/// The first byte chooses the kind of message that the remaining bytes form.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace understudy::compositor;
  static const std::vector<testing::MessageKind> kinds = testing::all_message_kinds();
  if (size == 0) return 0;
  const testing::MessageKind& kind = kinds[data[0] % kinds.size()];
  // A separate copy, so that sanitizers detect accesses outside.
  const auto bytes = std::as_bytes(std::span(data, size).subspan(1));
  const std::vector<std::byte> payload(bytes.begin(), bytes.end());
  std::vector<std::byte> written;
  try {
    written = kind.read_and_write_again(payload);
  } catch (const MalformedMessage&) {
    return 0;
  }
  if (kind.read_and_write_again(written) != written) std::abort();
  return 0;
}
