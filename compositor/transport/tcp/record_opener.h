// SPDX-License-Identifier: Apache-2.0
// The receiver's end of one direction of an encrypted session (record.h). Its memory is that of the longest
// record, whatever a peer says.
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

  /// Where the next bytes of the line belong; empty when a record is there whole, and is to be opened.
  std::span<std::byte> room();
  /// The first `count` bytes of room() are there now. True when a record is whole. Throws MalformedMessage for
  /// a length that no record has.
  bool took(std::size_t count);
  /// Bytes in the record that is there whole.
  std::size_t plain_bytes() const { return sealed_.size() - record_seal_bytes; }
  /// Writes plain_bytes() to `to`, which has as many; nothing before they are known to be authentic. Throws
  /// MalformedMessage for all but the next record of this session: nothing more can be opened then.
  void open(std::span<std::byte> to);

 private:
  enum class Step { stream_head, length, record, whole };

  std::span<std::byte> part();

  std::array<unsigned char, session_key_bytes> key_{};  ///< until the stream's head is there
  crypto_secretstream_xchacha20poly1305_state state_{};
  Step step_ = Step::stream_head;
  std::size_t have_ = 0;  ///< bytes of what is being read
  std::array<std::byte, stream_head_bytes> head_{};
  std::array<std::byte, record_length_bytes> length_{};
  std::vector<std::byte> record_;
  std::span<std::byte> sealed_;  ///< of record_
};

}  // namespace understudy::compositor
