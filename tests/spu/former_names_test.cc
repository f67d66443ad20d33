// SPDX-License-Identifier: Apache-2.0
// Options, variables and units under their former names: they must have the same effect as the current names.
#include "spu/former_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "spu/chain_json.h"
#include "spu/chain_text.h"
#include "spu/options.h"

namespace understudy::spu {
namespace {

using ::testing::ElementsAre;
using CommandLine = std::vector<std::string>;

/// An environment variable that is set for one test.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

TEST(FormerNames, OptionsAndTheirValuesAreTranslated) {
  struct Case {
    CommandLine former, present;
  };
  for (const Case& c : {
           Case{{"--polygons", "strips"}, {"--tiles", "on"}},
           Case{{"--polygons=root"}, {"--tiles=off"}},
           Case{{"--home", "gathered"}, {"--gather", "root"}},
           Case{{"--home", "direct"}, {"--gather", "direct"}},
           Case{{"--pipeline", "1"}, {"--frame-latency", "1"}},
           Case{{"--never-leave-out", "empty-blocks,known-colours,unchanged-pictures"},
                {"--disable-optimization", "empty-bricks,known-colours,unchanged-images"}},
           Case{{"--never-leave-out=lesser-samples"}, {"--disable-optimization=dominated-samples"}},
           Case{{"--stage", "--stage-opengl", "egl"}, {"--gl-server", "--server-opengl", "egl"}},
           Case{{"--door", "preload", "--table", "x"}, {"--injection", "preload", "--table", "x"}},
       }) {
    CommandLine former{"understudy", "run"}, present = former;
    former.insert(former.end(), c.former.begin(), c.former.end());
    present.insert(present.end(), c.present.begin(), c.present.end());
    EXPECT_EQ(with_present_options(former), present) << c.former.front();
    EXPECT_EQ(with_present_options(present), present) << "today's words stay as they are";
  }
}

TEST(FormerNames, TablesOfFilesAreTransferFunctions) {
  for (const char* command : {"render", "view"})
    EXPECT_THAT(
        with_present_options({"understudy", command, "--table", "strips", "--table=a.json"}),
        ElementsAre("understudy", command, "--transfer-function", "strips", "--transfer-function=a.json"));
}

TEST(FormerNames, VariablesSetTheSameOptions) {
  const Variable polygons("UNDERSTUDY_POLYGONS", "strips"), home("UNDERSTUDY_HOME", "gathered"),
      pipeline("UNDERSTUDY_PIPELINE", "1"), stage("UNDERSTUDY_STAGE_OPENGL", "osmesa"),
      never("UNDERSTUDY_NEVER_LEAVE_OUT", "lesser-samples,footprints");
  const auto expect_set = [] {
    const Options options = options_from_environment();
    EXPECT_TRUE(options.tiles);
    EXPECT_EQ(options.gather, "root");
    EXPECT_EQ(options.frame_latency, 1);
    EXPECT_EQ(options.server_opengl, "osmesa");
    Options expected;
    ASSERT_TRUE(set_option(expected, "UNDERSTUDY_DISABLE_OPTIMIZATION", "dominated-samples,footprints"));
    EXPECT_EQ(options.disabled_optimizations, expected.disabled_optimizations);
  };
  expect_set();
  rename_former_variables();
  EXPECT_EQ(std::getenv("UNDERSTUDY_POLYGONS"), nullptr);
  expect_set();
  for (const char* variable : {"UNDERSTUDY_TILES", "UNDERSTUDY_GATHER", "UNDERSTUDY_FRAME_LATENCY",
                               "UNDERSTUDY_SERVER_OPENGL", "UNDERSTUDY_DISABLE_OPTIMIZATION"})
    unsetenv(variable);
}

TEST(FormerNames, TodaysVariableGoesFirst) {
  const Variable former("UNDERSTUDY_POLYGONS", "strips"), present("UNDERSTUDY_TILES", "off");
  EXPECT_FALSE(options_from_environment().tiles);
}

TEST(FormerNames, UnitsAreThoseOfToday) {
  EXPECT_EQ(chain_text(parse_chain("pack link")), "pack remote");
  EXPECT_EQ(chain_text(parse_chain("strips(of=2, stages=x) strip(part=0) driver")),
            "tiles(of=2, gl-server=x) tile(part=0) driver");
  EXPECT_EQ(chain_text(parse_chain_json(R"({"chain": [{"unit": "strip", "part": 1}, "link"]})", "chain.json")),
            "tile(part=1) remote");
}

}  // namespace
}  // namespace understudy::spu
