// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/record_opener.h"

#include <sodium.h>

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "compositor/transport/wire.h"

namespace understudy::compositor {

namespace {

const unsigned char* unsigned_bytes(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

std::size_t length_of(std::span<const std::byte, record_length_bytes> bytes) {
  std::uint32_t length = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) length |= std::to_integer<std::uint32_t>(bytes[i]) << 8 * i;
  return length;
}

}  // namespace

RecordOpener::RecordOpener(std::span<const unsigned char, session_key_bytes> key)
    : record_(max_record_bytes + record_seal_bytes) {
  std::ranges::copy(key, key_.begin());
}

RecordOpener::~RecordOpener() {
  ::sodium_memzero(key_.data(), key_.size());
  ::sodium_memzero(&state_, sizeof state_);
}

std::span<std::byte> RecordOpener::part() {
  switch (step_) {
    case Step::stream_head:
      return head_;
    case Step::length:
      return length_;
    default:
      return sealed_;
  }
}

std::span<std::byte> RecordOpener::room() {
  return part().subspan(have_);
}

bool RecordOpener::took(std::size_t count) {
  have_ += count;
  if (!room().empty()) return false;
  if (step_ == Step::record) {
    step_ = Step::whole;
    return true;
  }
  have_ = 0;
  if (step_ == Step::stream_head) {
    ::crypto_secretstream_xchacha20poly1305_init_pull(&state_, unsigned_bytes(head_), key_.data());
    ::sodium_memzero(key_.data(), key_.size());
    step_ = Step::length;
    return false;
  }
  const std::size_t sealed_bytes = length_of(length_);
  if (sealed_bytes < record_seal_bytes || sealed_bytes > record_.size())
    throw MalformedMessage("a record has a length that none has: what came was changed on its way");
  sealed_ = std::span(record_).first(sealed_bytes);
  step_ = Step::record;
  return false;
}

void RecordOpener::open(std::span<std::byte> to) {
  assert(step_ == Step::whole && to.size() == plain_bytes());
  unsigned char tag = 0;
  if (::crypto_secretstream_xchacha20poly1305_pull(&state_, reinterpret_cast<unsigned char*>(to.data()),
                                                   nullptr, &tag, unsigned_bytes(sealed_), sealed_.size(),
                                                   unsigned_bytes(length_), length_.size()) != 0)
    throw MalformedMessage("a record does not open: what came was changed, replayed or left out on its way");
  step_ = Step::length;
  have_ = 0;
}

}  // namespace understudy::compositor
