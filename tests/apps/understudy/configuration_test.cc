// SPDX-License-Identifier: Apache-2.0
// Settings of a configuration file for a viewer.
#include "apps/understudy/configuration/configuration.h"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/compositor/scratch_folder.h"

namespace understudy::launcher {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Configuration : public ::testing::Test {
 protected:
  std::vector<std::string> words(const std::string& text, const std::vector<std::string>& viewer) {
    std::ofstream(file_) << text;
    std::vector<std::string> words;
    for (const ConfiguredOption& option : configured_options(file_, viewer))
      words.push_back(option.name + "=" + option.value + (option.is_true_or_false ? "!" : ""));
    return words;
  }
  std::string error_of(const std::string& text) {
    try {
      words(text, {"viewer"});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  }

  compositor::testing::ScratchFolder folder_;
  std::filesystem::path file_ = folder_ / "understudy.toml";
};

TEST_F(Configuration, IsNoneWhereThereIsNoFile) {
  EXPECT_THAT(configured_options(file_, {"viewer"}), IsEmpty());
  EXPECT_THAT(configured_options({}, {"viewer"}), IsEmpty());
}

TEST_F(Configuration, SectionsHoldForViewersOfTheirName) {
  const std::string text = "nodes = 2\nerror = \"2/255\"\n[ParaView]\nnodes = 4\n[other]\nnodes = 8\n";
  EXPECT_THAT(words(text, {"/usr/bin/paraview", "file"}), ElementsAre("nodes=4", "error=2/255"));
  EXPECT_THAT(words(text, {"glxgears"}), ElementsAre("error=2/255", "nodes=2"));
  EXPECT_THAT(words("Scan = { nodes = 3 }", {"python3", "-B", "tools/scan.py"}), ElementsAre("nodes=3"));
}

TEST_F(Configuration, TrueAndFalseAreOnAndOff) {
  EXPECT_THAT(words("explain = true\ntiles = false", {"viewer"}), ElementsAre("explain=on!", "tiles=off!"));
  EXPECT_THAT(words("explain = true\n[viewer]\nexplain = false", {"viewer"}), ElementsAre("explain=off!"));
}

TEST_F(Configuration, SaysInWhichLineItIsWrong) {
  EXPECT_THAT(error_of("nodes = \n"), HasSubstr("understudy.toml, line 1: "));
  EXPECT_THAT(error_of("error = 1\nnodes = [1, 2]\n"),
              HasSubstr("understudy.toml, line 2: nodes must be a string, a number, true or false"));
}

}  // namespace
}  // namespace understudy::launcher
