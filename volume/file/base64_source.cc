// SPDX-License-Identifier: Apache-2.0
#include "volume/file/base64_source.h"

namespace understudy::volume {

namespace {

constexpr std::size_t text_at_once = 1U << 16;

int digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

}  // namespace

Base64Source::Base64Source(std::shared_ptr<ByteSource> below, std::uint64_t offset)
    : ForwardSource(std::move(below)), start_(offset) {}

void Base64Source::restart() {
  from_ = start_;
  text_.clear();
  used_ = 0;
  bits_ = 0;
  bit_count_ = 0;
  ended_ = false;
}

// Returns -1 at the end of the text.
int Base64Source::next_digit() {
  for (;;) {
    if (used_ == text_.size()) {
      text_.resize(text_at_once);
      text_.resize(below().read(from_, text_));
      from_ += text_.size();
      used_ = 0;
      if (text_.empty()) return -1;
    }
    const char c = static_cast<char>(text_[used_++]);
    if (!is_space(c)) return digit(c);
  }
}

std::size_t Base64Source::next(std::span<std::byte> to) {
  std::size_t filled = 0;
  while (filled < to.size() && !ended_) {
    const int six = next_digit();
    if (six < 0) {
      ended_ = true;
      break;
    }
    bits_ = (bits_ << 6U | std::uint32_t(six)) & 0xFFFFU;
    bit_count_ += 6;
    if (bit_count_ < 8) continue;
    bit_count_ -= 8;
    to[filled++] = std::byte(bits_ >> std::uint32_t(bit_count_) & 0xFFU);
  }
  return filled;
}

}  // namespace understudy::volume
