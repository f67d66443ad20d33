// SPDX-License-Identifier: Apache-2.0
// Arbitrary trace files. Each is refused, or yields blocks of the sizes that its headers give.
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

#include "spu/stream/trace_file.h"

namespace {

using namespace understudy::spu;

void read(std::span<const std::byte> file) {
  try {
    TraceReader reader(file);
    while (const auto block = reader.next()) {
      if (block->records.size() > most_block_words || block->payload.size() > most_block_words) std::abort();
      for (std::size_t at = 0; at < block->records.size();) {
        const auto record = record_at(block->records, at, block->payload);
        if (!record) break;
        at += record->words.size();
      }
    }
  } catch (const std::runtime_error&) {
    // Not a trace.
  }
}

template <class Plain>
void append(std::vector<std::byte>& to, const Plain& value) {
  const auto bytes = std::as_bytes(std::span(&value, 1));
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// A trace file with one block and a valid checksum. The first words of the input fill the block's header; the
/// rest is the block's data, taken as compressed or to be compressed here.
std::vector<std::byte> trace_with(std::span<const std::byte> input, bool packed) {
  std::array<std::uint32_t, 3> said{};
  const std::size_t head = std::min(input.size(), sizeof said);
  std::memcpy(said.data(), input.data(), head);
  input = input.subspan(head);
  std::vector<std::byte> data(input.begin(), input.end());
  BlockHeader header;
  header.frames = said[0];
  header.record_words = packed ? said[1] : input.size() / 8 - std::min<std::size_t>(said[1], input.size() / 8);
  header.payload_words = packed ? said[2] : input.size() / 8 - header.record_words;
  if (!packed) {
    data.resize(ZSTD_compressBound(input.size()));
    data.resize(ZSTD_compress(data.data(), data.size(), input.data(), input.size(), 1));
  }
  header.compressed_bytes = data.size();
  header.checksum = header_checksum(header);
  std::vector<std::byte> file;
  append(file, trace_magic);
  append(file, std::array<std::uint32_t, 4>{trace_version});
  append(file, header);
  file.insert(file.end(), data.begin(), data.end());
  return file;
}

}  // namespace

/// The first byte chooses how the remaining bytes become a file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto input = std::as_bytes(std::span(data, size).subspan(1));
  if (data[0] % 3 == 0)
    read(input);
  else
    read(trace_with(input, data[0] % 3 == 1));
  return 0;
}
