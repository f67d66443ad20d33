// SPDX-License-Identifier: Apache-2.0
// Writes initial inputs that change with the protocols and are therefore not kept, into one folder per fuzzer.
//
//     write_seeds FOLDER
#include <zstd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "tests/compositor/message_kinds.h"
#include "tests/fuzz/remote_seeds.h"

namespace {

using namespace understudy;
using spu::testing::Seeds;

void write(const std::filesystem::path& folder, const Seeds& seeds) {
  std::filesystem::create_directories(folder);
  for (const auto& [name, bytes] : seeds)
    std::ofstream(folder / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

/// For node_message_fuzzer.cc: one message of each kind.
Seeds node_message_seeds() {
  Seeds seeds;
  int number = 0;
  for (const compositor::testing::MessageKind& kind : compositor::testing::all_message_kinds()) {
    std::vector<std::byte> input{std::byte(number++)};
    input.insert(input.end(), kind.bytes.begin(), kind.bytes.end());
    seeds[kind.name] = input;
  }
  return seeds;
}

/// For trace_fuzzer.cc: a block that is already compressed (1) and one that is not (2), of 20 words each, 6 of
/// them payload.
Seeds trace_seeds() {
  const std::array<std::uint64_t, 20> words = {std::uint64_t(3) << 32 | 7, 1, 2,
                                               std::uint64_t(3) << 32 | 9, 3, 4};
  const auto plain = std::as_bytes(std::span(words));
  std::vector<std::byte> packed(ZSTD_compressBound(plain.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), plain.data(), plain.size(), 1));
  const auto input = [](std::byte way, std::array<std::uint32_t, 3> said, std::span<const std::byte> data) {
    std::vector<std::byte> bytes{way};
    const auto head = std::as_bytes(std::span(said));
    bytes.insert(bytes.end(), head.begin(), head.end());
    bytes.insert(bytes.end(), data.begin(), data.end());
    return bytes;
  };
  return {{"packed", input(std::byte(1), {1, 14, 6}, packed)},
          {"plain", input(std::byte(2), {1, 6, 0}, plain)}};
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  const std::filesystem::path folder = arguments[1];
  write(folder / "remote", spu::testing::remote_seeds());
  write(folder / "gl_server", spu::testing::gl_server_seeds());
  write(folder / "record", spu::testing::record_seeds());
  write(folder / "node_message", node_message_seeds());
  write(folder / "trace", trace_seeds());
}
