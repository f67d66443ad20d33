// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/preset_file.h"

#include <gmock/gmock.h>

#include "apps/viewer/model/error.h"
#include "tests/apps/viewer/temporary_folder.h"

namespace viewer {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(PresetFile, HoldsItsControlPoints) {
  const viewer_test::TemporaryFolder folder;
  const PresetFile file(folder.write("t.json", R"({"knots": [
      {"at": 0.25, "colour": [1, 0.5, 0], "opacity": 0}, {"at": 0.75, "colour": [0, 0.5, 1], "opacity": 1}]})"));
  ASSERT_EQ(file.preset().points.size(), 2U);
  const Table table = make_table(file.preset(), 1, false);
  EXPECT_EQ(table[0], (Rgba8{255, 128, 0, 0}));
  EXPECT_EQ(table[255], (Rgba8{0, 128, 255, 255}));
  EXPECT_NEAR(table[128][3], 128, 1);
}

TEST(PresetFile, SaysWhatIsWrong) {
  const viewer_test::TemporaryFolder folder;
  const auto trouble = [&](const std::string& text) -> std::string {
    try {
      const PresetFile file(folder.write("t.json", text));
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("t.json"), HasSubstr("expected {\"knots\""))) << text;
      return error.what();
    }
    return "nothing";
  };
  const std::string point = R"({"at": 0.5, "colour": [1, 1, 1], "opacity": 0})";
  EXPECT_THAT(trouble("{"), HasSubstr("not a transfer function"));
  EXPECT_THAT(trouble("{}"), HasSubstr("not a transfer function"));
  EXPECT_THAT(trouble("{\"knots\": [" + point + "]}"), HasSubstr("1 control points are too few"));
  EXPECT_THAT(trouble("{\"knots\": [" + point + R"(, {"at": 0, "colour": [1, 1, 1], "opacity": 0}]})"),
              HasSubstr("control point 2 lies before"));
  EXPECT_THAT(trouble("{\"knots\": [" + point + R"(, {"at": 1, "colour": [1, 1, 1], "opacity": -1}]})"),
              HasSubstr("control point 2 has the value -1"));
  EXPECT_THAT(trouble("{\"knots\": [" + point + R"(, {"at": 1, "colour": [1, null, 1], "opacity": 1}]})"),
              HasSubstr("not a transfer function"));
  EXPECT_THROW(PresetFile(folder.file("nothing")), Error);
}

}  // namespace
}  // namespace viewer
