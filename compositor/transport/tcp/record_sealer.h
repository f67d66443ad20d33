// SPDX-License-Identifier: Apache-2.0
// The sender of one direction of an encrypted session (record.h).
#pragma once

#include <sodium/crypto_secretstream_xchacha20poly1305.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compositor/transport/tcp/record.h"
#include "compositor/transport/tcp/session_keys.h"

namespace understudy::compositor {

class RecordSealer {
 public:
  /// `key`: SessionKeys::send.
  explicit RecordSealer(std::span<const unsigned char, session_key_bytes> key);
  RecordSealer(const RecordSealer&) = delete;
  RecordSealer& operator=(const RecordSealer&) = delete;
  ~RecordSealer();

  /// Returns what is to be sent for `plain`, of at most max_record_bytes; valid until the next call.
  std::span<const std::byte> seal(std::span<const std::byte> plain);

 private:
  crypto_secretstream_xchacha20poly1305_state state_{};
  std::vector<std::byte> record_;  ///< room for the stream's head and the longest record
  bool begun_ = false;             ///< the stream's head has been returned
  std::uint32_t records_ = 0;      ///< sealed with this key
};

}  // namespace understudy::compositor
