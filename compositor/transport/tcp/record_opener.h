// SPDX-License-Identifier: Apache-2.0
// The receiver of one direction of an encrypted session (record.h). Needs memory for the longest record,
// whatever a peer sends.
#pragma once

#include <sodium/crypto_secretstream_xchacha20poly1305.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "compositor/transport/tcp/record.h"
#include "compositor/transport/tcp/session_keys.h"

namespace understudy::compositor {

class RecordOpener {
 public:
  /// `key`: SessionKeys::receive.
  explicit RecordOpener(std::span<const unsigned char, session_key_bytes> key);
  RecordOpener(const RecordOpener&) = delete;
  RecordOpener& operator=(const RecordOpener&) = delete;
  ~RecordOpener();

  /// Where the next bytes of the connection belong; empty when a record is complete and must be opened.
  std::span<std::byte> room();
  /// The first `count` bytes of room() have been filled. Returns true when a record is complete. Throws
  /// MalformedMessage for a length that no record has.
  bool took(std::size_t count);
  /// Size of the content of the complete record.
  std::size_t plain_bytes() const { return sealed_.size() - record_seal_bytes; }
  /// Decrypts the record to `to`, which has plain_bytes(); writes nothing before the bytes are known to be
  /// authentic. Throws MalformedMessage for anything but the next record of this session: nothing more can be
  /// opened then.
  void open(std::span<std::byte> to);

 private:
  enum class Step { stream_head, length, record, whole };

  std::span<std::byte> part();

  std::array<unsigned char, session_key_bytes> key_{};  ///< until the stream's head has arrived
  crypto_secretstream_xchacha20poly1305_state state_{};
  Step step_ = Step::stream_head;
  std::size_t have_ = 0;  ///< bytes of the part being read
  std::array<std::byte, stream_head_bytes> head_{};
  std::array<std::byte, record_length_bytes> length_{};
  std::vector<std::byte> record_;
  std::span<std::byte> sealed_;  ///< of record_
};

}  // namespace understudy::compositor
