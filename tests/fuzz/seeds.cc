// SPDX-License-Identifier: Apache-2.0
// Writes an initial corpus: records of all commands, a few per file, and scenes.
//
//     seeds FOLDER
#include <filesystem>
#include <fstream>
#include <random>

#include "spu/stream/encode.h"
#include "tests/fuzz/scenes.h"
#include "tests/spu/stream/any_call.h"
#include "tests/spu/stream/stateful_driver.h"

namespace {

using namespace understudy::spu;

void write(const std::filesystem::path& path, const Records& records) {
  std::ofstream file(path, std::ios::binary);
  const std::uint64_t words = records.words().size();
  file.write(reinterpret_cast<const char*>(&words), sizeof words);
  for (const auto part : {records.words(), records.payload()})
    file.write(reinterpret_cast<const char*>(part.data()), std::streamsize(part.size_bytes()));
}

void write_commands(const std::filesystem::path& folder) {
  testing::StatefulDriver driver;
  std::mt19937 random(1);
  constexpr std::size_t calls_per_file = 60;
  for (std::size_t first = 0; first < call_count; first += calls_per_file) {
    Records records;
    Encoder encoder(driver.table(), [] {});
    for (std::size_t i = first; i < std::min(first + calls_per_file, call_count); ++i)
      encoder.encode(CallId(i), testing::AnyCall(CallId(i), random).words(), records);
    write(folder / ("calls_" + std::to_string(first)), records);
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  const std::filesystem::path folder = arguments[1];
  write_commands(folder);
  for (const auto& [name, records] : testing::scenes()) write(folder / name, records);
}
