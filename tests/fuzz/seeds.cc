// Writes a corpus to begin with: records of all commands, a few to a file.
//
//     seeds FOLDER
#include <filesystem>
#include <fstream>
#include <random>

#include "spu/stream/encode.h"
#include "tests/spu/stream/any_call.h"
#include "tests/spu/stream/stateful_driver.h"

int main(int count, char** arguments) {
  using namespace understudy::spu;
  if (count != 2) return 2;
  testing::StatefulDriver driver;
  std::mt19937 random(1);
  constexpr std::size_t calls_per_file = 60;
  for (std::size_t first = 0; first < call_count; first += calls_per_file) {
    Records records;
    Encoder encoder(driver.table(), [] {});
    for (std::size_t i = first; i < std::min(first + calls_per_file, call_count); ++i)
      encoder.encode(CallId(i), testing::AnyCall(CallId(i), random).words(), records);
    std::ofstream file(std::filesystem::path(arguments[1]) / ("calls_" + std::to_string(first)),
                       std::ios::binary);
    const std::uint64_t words = records.words().size();
    file.write(reinterpret_cast<const char*>(&words), sizeof words);
    file.write(reinterpret_cast<const char*>(records.words().data()), std::streamsize(words * 8));
    file.write(reinterpret_cast<const char*>(records.payload().data()),
               std::streamsize(records.payload().size() * 8));
  }
}
