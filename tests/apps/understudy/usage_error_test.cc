// SPDX-License-Identifier: Apache-2.0
// Error messages for command lines that cannot be parsed.
#include "apps/understudy/option_table/usage_error.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/understudy/option_table/completion.h"
#include "apps/understudy/option_table/manual_page.h"
#include "apps/understudy/option_table/option_table.h"

namespace understudy::launcher {
namespace {

/// A program with two subcommands.
class Program {
 public:
  Program() {
    CLI::App* const run = app.add_subcommand("run", "runs a viewer");
    run->add_option("-n,--nodes", nodes, "ranks: many")->type_name("N");
    run->add_option("--sort", sort, "what is divided")
        ->type_name("last|first")
        ->check(CLI::IsMember({"last", "first"}).description(""));
    run->add_flag("--former", former, "as before")->group("");
    CLI::App* const render = app.add_subcommand("render", "an image");
    render->add_option("VOLUME", volume, "a file")->required();
    render->add_flag("--progress", former, "'quoted' .dot");
    app.add_subcommand("player", "internal")->group("");
    app.require_subcommand(1);
  }

  std::string said_of(std::vector<std::string> words) {
    try {
      app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const CLI::ParseError& error) {
      const std::string text = usage_error_text(app, words, error);
      return text.substr(0, text.find('\n'));
    }
    return "(parsed)";
  }

  CLI::App app{"Does things.", "prog"};
  int nodes = 0;
  std::string sort, volume;
  bool former = false;
};

TEST(UsageErrors, NameTheWordAndTheNearestRightOne) {
  const auto said_of = [](std::vector<std::string> words) { return Program().said_of(std::move(words)); };
  EXPECT_EQ(said_of({"rnu"}), "prog: there is no subcommand 'rnu'; did you mean 'run'?");
  EXPECT_EQ(said_of({"zebra"}), "prog: there is no subcommand 'zebra'");
  EXPECT_EQ(said_of({}), "prog: the subcommand is missing; give one of run, render");
  EXPECT_EQ(said_of({"run", "--ndoes", "2"}), "prog: run has no option --ndoes; did you mean '--nodes'?");
  EXPECT_EQ(said_of({"run", "--ndoes=2"}), "prog: run has no option --ndoes; did you mean '--nodes'?");
  EXPECT_EQ(said_of({"run", "--sort", "fist"}),
            "prog: --sort: 'fist' is not one of last, first; did you mean 'first'?");
  EXPECT_EQ(said_of({"run", "--sort=middle"}), "prog: --sort: 'middle' is not one of last, first");
  EXPECT_EQ(said_of({"run", "viewer", "--fullscreen"}),
            "prog: put -- before the viewer's command: understudy run [options] -- viewer args…");
  EXPECT_EQ(said_of({"render", "a", "b"}), "prog: render does not take 'b'");
  EXPECT_EQ(said_of({"render"}), "prog: render: VOLUME is required");
  EXPECT_EQ(said_of({"--halp"}), "prog: there is no option '--halp'; did you mean '--help'?");
  // Hidden options and subcommands are not suggested.
  EXPECT_EQ(said_of({"run", "--formr"}), "prog: run has no option --formr");
  EXPECT_EQ(said_of({"playr"}), "prog: there is no subcommand 'playr'");
  EXPECT_EQ(said_of({"run", "--former"}), "(parsed)");
}

TEST(UsageErrors, NearWordsHaveAThirdOfTheirLettersWrong) {
  const std::vector<std::string> known{"replay", "render", "run", "completion"};
  EXPECT_EQ(nearest_word("rendr", known), "render");
  EXPECT_EQ(nearest_word("redner", known), "render");
  EXPECT_EQ(nearest_word("comp", known), "completion") << "a beginning";
  EXPECT_EQ(nearest_word("nur", known), "");
  EXPECT_EQ(nearest_word("rn", known), "run");
  EXPECT_EQ(nearest_word("", known), "");
  EXPECT_EQ(nearest_word("viewer", known), "");
}

TEST(OptionTable, HoldsWhatIsNotHidden) {
  const Program program;
  const std::vector<SubcommandRow> rows = option_table(program.app);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].name, "run");
  ASSERT_EQ(rows[0].options.size(), 3U) << "help, nodes, sort";
  EXPECT_EQ(rows[0].options[1].names, (std::vector<std::string>{"-n", "--nodes"}));
  EXPECT_EQ(rows[0].options[2].values, (std::vector<std::string>{"last", "first"}));
  EXPECT_EQ(rows[1].options[1].place, "VOLUME");
}

TEST(OptionTable, IsWrittenForEveryReader) {
  const Program program;
  const std::vector<SubcommandRow> rows = option_table(program.app);
  const std::string page = text_of({"prog", "1.2.3", "does things", rows, {{"prog-node", "a part"}}});
  EXPECT_NE(page.find(".TH PROG 1 \"\" \"prog 1.2.3\""), std::string::npos);
  EXPECT_NE(page.find("\\fB\\-n\\fR, \\fB\\-\\-nodes\\fR \\fIN\\fR"), std::string::npos);
  EXPECT_NE(page.find("\\&'quoted' .dot"), std::string::npos) << "which is no command of the language";
  const std::string bash = completion_text("bash", "prog", rows);
  EXPECT_NE(bash.find("'run --sort') words='last first'; files=false ;;"), std::string::npos);
  EXPECT_NE(completion_text("fish", "prog", rows).find("-d ''\\''quoted'\\'' .dot'"), std::string::npos);
  EXPECT_THROW(completion_text("tcsh", "prog", rows), std::invalid_argument);
}

}  // namespace
}  // namespace understudy::launcher
