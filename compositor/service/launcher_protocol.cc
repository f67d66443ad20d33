// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/launcher_protocol.h"

#include <algorithm>

#include "compositor/service/limits.h"

namespace understudy::compositor {

std::vector<std::byte> encode(const Hello& hello) {
  Writer out;
  out.integer(hello.ranks);
  return out.bytes();
}

Hello decode_hello(std::span<const std::byte> payload) {
  Reader in("hello", payload);
  const Hello hello{in.small("ranks", 1, limits::max_ranks)};
  in.end();
  return hello;
}

std::vector<std::byte> encode(const Alive& alive) {
  Writer out;
  out.integer(alive.unwanted_ms);
  return out.bytes();
}

Alive decode_alive(std::span<const std::byte> payload) {
  Reader in("alive", payload);
  const Alive alive{in.small("unwanted", 0, limits::max_unwanted_ms)};
  in.end();
  return alive;
}

std::vector<std::byte> encode_text(const std::string& text) {
  Writer out;
  out.run(std::as_bytes(std::span(text).first(std::min(text.size(), limits::max_text_bytes))));
  return out.bytes();
}

std::string decode_text(std::span<const std::byte> payload) {
  Reader in("refusal", payload);
  const auto bytes = in.run("text", limits::max_text_bytes);
  in.end();
  std::string text(bytes.size(), ' ');
  // A peer's text is written to a terminal: one line, without control characters.
  std::ranges::transform(bytes, text.begin(), [](std::byte b) {
    const char c = char(b);
    return c >= 0 && c < ' ' ? ' ' : c;
  });
  return text;
}

}  // namespace understudy::compositor
