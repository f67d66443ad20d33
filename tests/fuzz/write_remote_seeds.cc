// SPDX-License-Identifier: Apache-2.0
// write_remote_seeds FOLDER_OF_LINKS FOLDER_OF_STAGES FOLDER_OF_RECORDS
#include <filesystem>
#include <fstream>

#include "tests/fuzz/remote_seeds.h"

namespace {

void write(const std::filesystem::path& folder, const understudy::spu::testing::Seeds& seeds) {
  for (const auto& [name, bytes] : seeds)
    std::ofstream(folder / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) return 2;
  write(arguments[1], understudy::spu::testing::remote_seeds());
  write(arguments[2], understudy::spu::testing::gl_server_seeds());
  write(arguments[3], understudy::spu::testing::record_seeds());
}
