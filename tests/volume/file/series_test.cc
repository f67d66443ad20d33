// SPDX-License-Identifier: Apache-2.0
// Which files form a series, and in which order.
#include "volume/file/series.h"

#include <gtest/gtest.h>

#include "tests/volume/file/volume_files.h"
#include "volume/file/file_error.h"

namespace understudy::volume::testing {
namespace {

TEST(Series, ComesInTheOrderOfItsNumbers) {
  const TemporaryFolder folder;
  for (const char* name : {"step_10.raw", "step_9.raw", "step_100.raw", "step_01.raw", "other.raw"})
    folder.write(name, std::string("x"));
  std::vector<std::string> names;
  for (const std::string& file : files_of_series({folder.file("step_*.raw")}))
    names.push_back(file.substr(file.rfind('/') + 1));
  EXPECT_EQ(names, (std::vector<std::string>{"step_01.raw", "step_9.raw", "step_10.raw", "step_100.raw"}));
}

TEST(Series, OrdersAnyTwoNamesOneWay) {
  const std::vector<std::string> names{
      "",      "1",    "01",    "001",  "2",     "10",  "a",
      "a1",    "a01b", "a1b",   "a1b2", "a1b10", "b",   "a99999999999999999999",
      "a9_10", "a9_9", "a09_9", "a-1",  "a_1",   "a1a", "a100000000000000000000"};
  for (const std::string& a : names) {
    EXPECT_FALSE(comes_before(a, a)) << a;
    for (const std::string& b : names) {
      if (a != b) {
        EXPECT_NE(comes_before(a, b), comes_before(b, a)) << a << " " << b;
      }
      for (const std::string& c : names)
        if (comes_before(a, b) && comes_before(b, c)) {
          EXPECT_TRUE(comes_before(a, c)) << a << " " << b << " " << c;
        }
    }
  }
  EXPECT_TRUE(comes_before("a99999999999999999999", "a100000000000000000000"));
}

TEST(Series, AStepHasAName) {
  EXPECT_EQ(name_of({"/a/step_3.vti", std::nullopt}), "step_3.vti");
  EXPECT_EQ(name_of({"/a/bold.nii.gz", 7}), "bold.nii.gz, 7");
}

TEST(Series, ANameThatIsThereMeansItself) {
  const TemporaryFolder folder;
  folder.write("a[1].raw", std::string("x"));
  EXPECT_EQ(files_of_series({folder.file("a[1].raw"), "synthetic:8x8x8"}),
            (std::vector<std::string>{folder.file("a[1].raw"), "synthetic:8x8x8"}));
  EXPECT_EQ(files_of_series({"not/there.raw"}), std::vector<std::string>{"not/there.raw"})
      << "who opens it says so";
  EXPECT_THROW(files_of_series({folder.file("b*.raw")}), FileError);
}

}  // namespace
}  // namespace understudy::volume::testing
