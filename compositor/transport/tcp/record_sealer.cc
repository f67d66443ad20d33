// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/record_sealer.h"

#include <sodium.h>

#include <cassert>
#include <cstring>

namespace understudy::compositor {

namespace {

unsigned char* unsigned_bytes(std::byte* bytes) {
  return reinterpret_cast<unsigned char*>(bytes);
}

}  // namespace

RecordSealer::RecordSealer(std::span<const unsigned char, session_key_bytes> key)
    : record_(stream_head_bytes + record_length_bytes + max_record_bytes + record_seal_bytes) {
  static_assert(crypto_secretstream_xchacha20poly1305_KEYBYTES == session_key_bytes);
  static_assert(crypto_secretstream_xchacha20poly1305_HEADERBYTES == stream_head_bytes);
  static_assert(crypto_secretstream_xchacha20poly1305_ABYTES == record_seal_bytes);
  ::crypto_secretstream_xchacha20poly1305_init_push(&state_, unsigned_bytes(record_.data()), key.data());
}

RecordSealer::~RecordSealer() {
  ::sodium_memzero(&state_, sizeof state_);
}

std::span<const std::byte> RecordSealer::seal(std::span<const std::byte> plain) {
  assert(plain.size() <= max_record_bytes);
  const auto sealed_bytes = std::uint32_t(plain.size() + record_seal_bytes);
  std::byte* const length = record_.data() + stream_head_bytes;
  for (std::size_t i = 0; i < record_length_bytes; ++i) length[i] = std::byte(sealed_bytes >> 8 * i);
  const bool last_of_key = ++records_ == records_of_a_key;
  if (last_of_key) records_ = 0;
  ::crypto_secretstream_xchacha20poly1305_push(
      &state_, unsigned_bytes(length + record_length_bytes), nullptr,
      reinterpret_cast<const unsigned char*>(plain.data()), plain.size(), unsigned_bytes(length),
      record_length_bytes, last_of_key ? crypto_secretstream_xchacha20poly1305_TAG_REKEY : 0);
  const std::size_t skipped = begun_ ? stream_head_bytes : 0;
  begun_ = true;
  return std::span(record_).subspan(skipped, stream_head_bytes - skipped + record_length_bytes + sealed_bytes);
}

}  // namespace understudy::compositor
