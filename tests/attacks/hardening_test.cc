// SPDX-License-Identifier: Apache-2.0
// Hardening options of programs and libraries: an exploited error should achieve no more than ending the
// process.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/clients/command_test.h"

namespace attacks {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

class Hardening : public clients::CommandTest {
 protected:
  static std::vector<std::string> binaries() {
    std::vector<std::string> found;
    for (const char* name : {"understudy", "understudy-node", "understudy-view", "understudy-viewer"})
      found.push_back(clients::programs / name);
    for (const fs::path& folder : {clients::libraries, clients::libraries / "entry"})
      for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().filename().string().find(".so") != std::string::npos)
          found.push_back(entry.path());
    return found;
  }
  std::string readelf(const std::string& option, const std::string& binary) const {
    return run_well({"readelf", "--wide", option, binary}).out;
  }
};

TEST_F(Hardening, OfEveryProgramAndLibrary) {
  EXPECT_GE(binaries().size(), 10U);
  for (const std::string& binary : binaries()) {
    const std::string segments = readelf("-l", binary);
    EXPECT_THAT(segments, HasSubstr("GNU_RELRO")) << binary;
    EXPECT_THAT(segments, Not(HasSubstr("RWE"))) << binary << " has memory that is written and executed";
    EXPECT_THAT(readelf("-d", binary), HasSubstr("NOW")) << binary << " is bound lazily";
    // Position-independent programs, and libraries.
    EXPECT_THAT(readelf("-h", binary), HasSubstr("DYN")) << binary;
  }
}

TEST_F(Hardening, ChecksStacksAndLengths) {
  for (const char* name : {"understudy", "understudy-node"}) {
    const std::string symbols = readelf("--dyn-syms", clients::programs / name);
    EXPECT_THAT(symbols, HasSubstr("__stack_chk_fail")) << name;
    EXPECT_THAT(symbols, HasSubstr("_chk@GLIBC")) << name << " is built without FORTIFY";
  }
}

#ifdef __CET__
TEST_F(Hardening, MarksWhereIndirectBranchesMayGo) {
  constexpr const char* endbr64 = "\xF3\x0F\x1E\xFA";
  for (const fs::path& binary : {clients::programs / "understudy", clients::programs / "understudy-node",
                                 clients::libraries / "libunderstudy.so"})
    EXPECT_THAT(clients::contents(binary), HasSubstr(endbr64)) << binary;
}
#endif

}  // namespace
}  // namespace attacks
