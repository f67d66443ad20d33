// SPDX-License-Identifier: Apache-2.0
// Command line and environment are parsed by one table.
#include "spu/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>

namespace understudy::spu {
namespace {

TEST(Options, HaveOneRowEachAndOneVariableEach) {
  std::set<std::string> variables;
  for (const OptionText& option : option_table()) {
    EXPECT_TRUE(variables.insert(option.environment).second) << option.environment;
    EXPECT_EQ(std::string(option.environment).rfind("UNDERSTUDY_", 0), 0U) << option.environment;
    EXPECT_NE(std::string(option.help), "") << option.environment;
  }
  for (const char* name : {"NODES", "CONNECT", "REPORT", "VERIFY", "EXPLAIN", "DISABLE"}) {
    EXPECT_EQ(variables.count(std::string("UNDERSTUDY_") + name), 1U) << name;
  }
}

TEST(Options, DefaultsInTheTableAreThoseInTheStructure) {
  for (const OptionText& option : option_table()) {
    Options options;
    ASSERT_TRUE(set_option(options, option.environment, option.fallback)) << option.environment;
    const Options untouched;
    EXPECT_EQ(options.nodes, untouched.nodes);
    EXPECT_EQ(options.verify, untouched.verify);
    EXPECT_EQ(options.verify_psnr, untouched.verify_psnr);
    EXPECT_EQ(options.explain, untouched.explain);
    EXPECT_EQ(options.disable, untouched.disable);
    EXPECT_EQ(options.debug_tint, untouched.debug_tint);
    EXPECT_EQ(options.chain, untouched.chain);
    EXPECT_EQ(options.server_opengl, untouched.server_opengl);
    EXPECT_EQ(options.sandbox, untouched.sandbox);
    EXPECT_EQ(options.error, untouched.error);
    EXPECT_EQ(options.time_ms, untouched.time_ms);
  }
}

TEST(Options, ErrorsAreNumbersOrFractionsAndTimesHaveUnits) {
  Options options;
  EXPECT_EQ(options.error, 0);
  EXPECT_TRUE(set_option(options, "UNDERSTUDY_ERROR", "0.5/255"));
  EXPECT_DOUBLE_EQ(options.error, 0.5 / 255);
  EXPECT_TRUE(set_option(options, "UNDERSTUDY_ERROR", "2e-3"));
  for (const char* text : {"0", "10", "abc", "1/0", "2/1", "-0.1", "nan", "0.1/", "/255", "inf", ""}) {
    EXPECT_FALSE(set_option(options, "UNDERSTUDY_ERROR", text)) << text;
    EXPECT_DOUBLE_EQ(options.error, 2e-3);
  }
  EXPECT_TRUE(set_option(options, "UNDERSTUDY_TIME", "0.03s"));
  EXPECT_DOUBLE_EQ(options.time_ms, 30);
  EXPECT_TRUE(set_option(options, "UNDERSTUDY_TIME", "25ms"));
  EXPECT_TRUE(set_option(options, "UNDERSTUDY_TIME", "25"));
  for (const char* text : {"0", "-3ms", "3 hours", "61s", "s", "ms", "1e3", ""}) {
    EXPECT_FALSE(set_option(options, "UNDERSTUDY_TIME", text)) << text;
    EXPECT_DOUBLE_EQ(options.time_ms, 25);
  }
}

TEST(Options, TakeValuesInRangeAndRefuseOthersUnchanged) {
  Options options;
  EXPECT_TRUE(set_option(options, "UNDERSTUDY_NODES", "7"));
  EXPECT_EQ(options.nodes, 7);
  const std::string too_many = std::to_string(max_nodes + 1);
  for (const char* text : {"-1", "many", "", "4x", " 4", too_many.c_str()}) {
    EXPECT_FALSE(set_option(options, "UNDERSTUDY_NODES", text)) << text;
    EXPECT_EQ(options.nodes, 7);
  }
  EXPECT_FALSE(set_option(options, "UNDERSTUDY_VERIFY_PSNR", "nan"));
  EXPECT_FALSE(set_option(options, "UNDERSTUDY_NO_SUCH_OPTION", "1"));
}

TEST(Options, SwitchesTakeTheUsualWords) {
  Options options;
  for (const char* on : {"1", "on", "yes", "true"}) {
    options.explain = false;
    EXPECT_TRUE(set_option(options, "UNDERSTUDY_EXPLAIN", on) && options.explain) << on;
  }
  for (const char* off : {"0", "off", "no", "false", ""}) {
    options.explain = true;
    EXPECT_TRUE(set_option(options, "UNDERSTUDY_EXPLAIN", off) && !options.explain) << off;
  }
  EXPECT_FALSE(set_option(options, "UNDERSTUDY_EXPLAIN", "perhaps"));
}

TEST(Options, AVariableThatCannotBeReadIsSaidAndItsDefaultTaken) {
  setenv("UNDERSTUDY_NODES", "lots", 1);
  setenv("UNDERSTUDY_VERIFY", "10", 1);
  ::testing::internal::CaptureStderr();
  const Options options = options_from_environment();
  const std::string said = ::testing::internal::GetCapturedStderr();
  unsetenv("UNDERSTUDY_NODES");
  unsetenv("UNDERSTUDY_VERIFY");
  EXPECT_EQ(options.nodes, 0);
  EXPECT_EQ(options.verify, 10);
  EXPECT_THAT(said, ::testing::HasSubstr("UNDERSTUDY_NODES=lots is not a value"));
}

}  // namespace
}  // namespace understudy::spu
