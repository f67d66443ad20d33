// SPDX-License-Identifier: Apache-2.0
// Chains from text: which ones are assembled, and the error messages for the others.
#include "spu/registry/assemble.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <set>

#include "spu/pass/pass.h"
#include "spu/track/share_group.h"
#include "spu/track/track.h"
#include "tests/spu/mock_driver.h"

namespace understudy::spu {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::array<const char*, 2> shapes = {"round", "square"};

constexpr UnitOption sample_options[] = {
    {.name = "loud", .type = OptionType::on_off, .fallback = "off", .help = "a switch"},
    {.name = "level", .type = OptionType::integer, .fallback = "3", .low = 1, .high = 9, .help = "an integer"},
    {.name = "weight", .type = OptionType::number, .fallback = "0.5", .low = 0, .high = 1, .help = "a number"},
    {.name = "title", .type = OptionType::text, .fallback = "none", .help = "a text"},
    {.name = "file", .type = OptionType::file, .fallback = "", .help = "a file"},
    {.name = "shape", .type = OptionType::choice, .fallback = "round", .choices = shapes, .help = "a choice"},
    {.name = "frames", .type = OptionType::range, .fallback = "1-", .help = "a range"}};

OptionValues made_with;

constinit const UnitDescription sample_description{.name = "sample",
                                                   .help = "has an option of every type",
                                                   .options = sample_options,
                                                   .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
                                                     made_with = place.options;
                                                     return std::make_unique<Pass>();
                                                   }};

/// All units, and the sample unit.
UnitTable units() {
  static const std::vector<const UnitDescription*> all = [] {
    std::vector<const UnitDescription*> table(unit_table().begin(), unit_table().end());
    table.push_back(&sample_description);
    return table;
  }();
  return all;
}

class Assemble : public ::testing::Test {
 protected:
  std::string error_of(std::string_view text) {
    Chain chain(mock_.table(), std::make_shared<ShareGroup>(), testing::install);
    std::string error = assemble(chain, text, nullptr, units()).value_or("");
    if (!error.empty()) {
      EXPECT_EQ(&chain.head(Phase::plain), &mock_.table()) << "a chain with an error adds no unit: " << text;
    }
    return error;
  }

  testing::MockDriver mock_;
};

TEST_F(Assemble, KnowsItsUnitsByName) {
  std::set<std::string> names;
  for (const UnitDescription* unit : unit_table()) {
    EXPECT_TRUE(names.insert(unit->name).second) << unit->name;
    EXPECT_STRNE(unit->help, "") << unit->name;
    EXPECT_EQ(unit->make == nullptr, std::string_view(unit->name) == "driver") << unit->name;
    // Defaults must be valid values; otherwise option_values() throws.
    UnitSetting defaults{unit->name, {}, "here"};
    for (const UnitOption& option : unit->options) {
      EXPECT_STRNE(option.help, "") << unit->name << " " << option.name;
      defaults.options.push_back({option.name, option.fallback, "here"});
    }
    EXPECT_NO_THROW(option_values(defaults, unit->options)) << unit->name;
  }
  for (const char* name : {"driver", "null", "pass", "perf", "print", "track", "volume"}) {
    EXPECT_TRUE(names.count(name)) << name;
  }
}

// Without a server connection, `remote` cannot be made, and `pack` before it would have no unit to pass calls
// to.
TEST_F(Assemble, MakesAChainWholeOrNotAtAll) {
  EXPECT_THAT(error_of("pack remote"), HasSubstr("understudy run --remote"));
  EXPECT_THAT(error_of("perf(file=calls.json) pack remote"), HasSubstr("understudy run --remote"));
}

TEST_F(Assemble, EveryUnitStandsAboveTheDriver) {
  for (const UnitDescription* unit : unit_table()) {
    if (unit->position == UnitPosition::last) continue;
    // Such pairs are assembled from their first unit; traces are files and have tests of their own.
    if (std::string_view(unit->name) == "unpack" || std::string_view(unit->name) == "trace") continue;
    // `tiles` needs tile workers and their addresses (tests/spu/tiles).
    if (std::string_view(unit->name) == "tiles") continue;
    std::string chain;
    for (const char* name : {unit->needs, unit->name, unit->leads_to, "driver"}) {
      if (name != nullptr) chain.append(name).append(" ");
    }
    EXPECT_EQ(error_of(chain), "") << unit->name;
  }
}

TEST_F(Assemble, TilesWithoutGlServersAreToldWhereTheyAre) {
  EXPECT_THAT(error_of("tiles(of=2) driver"), HasSubstr("--tiles on"));
}

TEST_F(Assemble, MakesUnitsInTheirOrder) {
  Chain chain(mock_.table(), std::make_shared<ShareGroup>(), testing::install);
  ASSERT_EQ(assemble(chain, "pass track pass driver", nullptr).value_or(""), "");
  ASSERT_NE(chain.find<Track>(), nullptr);
  EXPECT_NE(chain.find<Pass>(), nullptr);
  EXPECT_EQ(&chain.below(*chain.find<Pass>(), Phase::plain), &chain.face(*chain.find<Track>(), Phase::plain));
}

TEST_F(Assemble, UnknownUnitsAreMetWithThoseThereAre) {
  EXPECT_THAT(error_of("trak driver"),
              StartsWith("chain, character 1: no unit is named trak; did you mean track? "
                         "There are: driver, null, pack, pass, perf, print, remote, tile, "));
  EXPECT_THAT(error_of("track zebra driver"),
              StartsWith("chain, character 7: no unit is named zebra. There are: "));
  EXPECT_THAT(error_of("Track driver"), HasSubstr("did you mean track?"));
  const std::string long_name(5000, 'a');
  EXPECT_LT(error_of(long_name + " driver").size(), 400U);
}

TEST_F(Assemble, UnitsThatCannotStandWhereTheyStandAreRefused) {
  EXPECT_EQ(error_of("volume driver"),
            "chain, character 1: volume needs track before it; write \"track volume\"");
  EXPECT_THAT(error_of("volume track driver"), HasSubstr("volume needs track before it"));
  EXPECT_EQ(error_of("track volume"),
            "chain, character 7: the chain must end in driver, the real OpenGL; write it last");
  EXPECT_EQ(error_of(""), "chain: the chain must end in driver, the real OpenGL; write it last");
  EXPECT_EQ(error_of("driver track"),
            "chain, character 8: track stands behind driver, which must be last; move it before");
  EXPECT_THAT(error_of("driver driver"), HasSubstr("stands behind driver"));
  EXPECT_EQ(error_of("track track driver"),
            "chain, character 7: track can stand only once in a chain, and is there already");
  EXPECT_THAT(error_of("perf track perf driver"), HasSubstr("perf can stand only once"));
  EXPECT_EQ(error_of("pass pass pass driver"), "");
}

TEST_F(Assemble, OptionsHaveTheirTypes) {
  EXPECT_EQ(
      error_of(
          R"(sample(loud, level=9, weight=0.25, title="two words", file=f, shape=square, frames=2-4) driver)"),
      "");
  EXPECT_TRUE(made_with.is_on("loud"));
  EXPECT_EQ(made_with.integer("level"), 9);
  EXPECT_EQ(made_with.number("weight"), 0.25);
  EXPECT_EQ(made_with.text("title"), "two words");
  EXPECT_EQ(made_with.text("file"), "f");
  EXPECT_EQ(made_with.text("shape"), "square");
  EXPECT_EQ(made_with.range("frames"), (IntegerRange{2, 4}));
  EXPECT_EQ(error_of("sample driver"), "");
  EXPECT_FALSE(made_with.is_on("loud"));
  EXPECT_EQ(made_with.integer("level"), 3);
  EXPECT_EQ(made_with.range("frames").first, 1);
  EXPECT_EQ(error_of("sample(frames=7, loud=no) driver"), "");
  EXPECT_EQ(made_with.range("frames"), (IntegerRange{7, 7}));
}

TEST_F(Assemble, OptionsThatCannotBeAreRefused) {
  EXPECT_EQ(error_of("sample(level=10) driver"),
            "chain, character 8: level of sample is a whole number from 1 to 9, not '10'");
  for (const char* value :
       {"level=0", "level=3.0", "level=many", "level=", "level=99999999999999999999", "weight=1.5",
        "weight=nan", "loud=perhaps", "frames=4-2", "frames=-3", "frames=a", "frames=1-2-3", "frames="}) {
    EXPECT_THAT(error_of("sample(" + std::string(value) + ") driver"), StartsWith("chain, character 8: "))
        << value;
  }
  EXPECT_EQ(error_of("sample(shape=oval) driver"),
            "chain, character 8: shape of sample is one of round, square, not 'oval'");
  EXPECT_THAT(
      error_of("sample(levle=3) driver"),
      StartsWith("chain, character 8: sample has no option levle; did you mean level? It has: loud, level"));
  EXPECT_EQ(error_of("pass(level=3) driver"), "chain, character 6: pass has no option level. It has none");
  EXPECT_EQ(error_of("sample(level=3, level=4) driver"),
            "chain, character 17: the option level is given twice; keep one");
}

TEST_F(Assemble, AFileStandsForItsChain) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "assemble-test.json";
  std::ofstream(file) << R"({"chain": [{"unit": "sample", "level": 7, "file": "x"}, "driver"]})";
  EXPECT_EQ(error_of("@" + file.string()), "");
  EXPECT_EQ(made_with.integer("level"), 7);
  EXPECT_EQ(error_of(file.string()), "");
  EXPECT_EQ(resolved_chain("@" + file.string(), "/folder", units()), "sample(level=7, file=/folder/x) driver");
  std::ofstream(file) << R"({"chain": [{"unit": "sample", "level": 70}, "driver"]})";
  EXPECT_THAT(error_of(file.string()),
              EndsWith("assemble-test.json, chain[0].level: level of sample is a whole "
                       "number from 1 to 9, not '70'"));
  std::filesystem::remove(file);
  EXPECT_THAT(error_of(file.string()), HasSubstr("cannot read this chain file"));
}

TEST_F(Assemble, FilesThatUnitsWriteAreThoseThatTheirOptionsName) {
  using Files = std::vector<std::filesystem::path>;
  EXPECT_EQ(files_of_units("sample(file=/a/b, title=/c) pass driver", units()), Files{"/a/b"});
  EXPECT_EQ(files_of_units("sample(file=) pass driver", units()), Files());
}

TEST_F(Assemble, AResolvedChainMeansTheSameInEveryFolder) {
  EXPECT_EQ(resolved_chain("sample(file=a/b) pass  driver", "/somewhere", units()),
            "sample(file=/somewhere/a/b) pass driver");
  EXPECT_EQ(resolved_chain("sample(file=/a, title=b) driver", "/somewhere", units()),
            "sample(file=/a, title=b) driver");
  EXPECT_EQ(resolved_chain("sample(file=) driver", "/somewhere", units()), "sample(file=\"\") driver");
  EXPECT_THROW(resolved_chain("sample", "/", units()), ChainError);
}

}  // namespace
}  // namespace understudy::spu
