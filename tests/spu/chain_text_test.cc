// SPDX-License-Identifier: Apache-2.0
// Chains as text and as JSON: what is parsed, and the error messages for what is refused. No units are
// involved.
#include "spu/chain_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>

#include "spu/chain_json.h"

namespace understudy::spu {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string error_of(std::string_view text) {
  try {
    parse_chain(text);
  } catch (const ChainError& error) {
    return error.what();
  }
  return "";
}

std::string json_error_of(std::string_view json) {
  try {
    parse_chain_json(json, "c.json");
  } catch (const ChainError& error) {
    return error.what();
  }
  return "";
}

TEST(ChainText, NamesUnitsInTheirOrder) {
  const ChainSettings chain = parse_chain(" track\tvolume\ndriver ");
  ASSERT_EQ(chain.size(), 3U);
  EXPECT_EQ(chain[0].name, "track");
  EXPECT_EQ(chain[2].name, "driver");
  EXPECT_EQ(chain[1].where, "chain, character 8");
  EXPECT_TRUE(parse_chain("").empty());
  EXPECT_TRUE(parse_chain(" \n").empty());
}

TEST(ChainText, GivesUnitsOptions) {
  const ChainSettings chain =
      parse_chain(R"(trace(file=a.ust, level = 3,quiet) b( ) c(text="a, (b) \"c\" \\", e=) d(x=k=v))");
  ASSERT_EQ(chain.size(), 4U);
  ASSERT_EQ(chain[0].options.size(), 3U);
  EXPECT_EQ(chain[0].options[0].name, "file");
  EXPECT_EQ(chain[0].options[0].value, "a.ust");
  EXPECT_EQ(chain[0].options[1].value, "3");
  EXPECT_EQ(chain[0].options[1].where, "chain, character 19");
  EXPECT_EQ(chain[0].options[2].value, "on") << "a name alone switches on";
  EXPECT_TRUE(chain[1].options.empty());
  EXPECT_EQ(chain[2].options[0].value, R"(a, (b) "c" \)");
  EXPECT_EQ(chain[2].options[1].value, "");
  EXPECT_EQ(chain[3].options[0].value, "k=v");
}

TEST(ChainText, ErrorsNameThePlaceAndWhatBelongsThere) {
  EXPECT_EQ(error_of("track, volume"),
            "chain, character 6: a unit's name belongs here (letters, digits, '-' and '_'), not ','");
  EXPECT_THAT(error_of("track("), StartsWith("chain, character 6: this parenthesis is not closed"));
  EXPECT_THAT(error_of("track(a=1 b=2)"), StartsWith("chain, character 11: ',' or ')' belongs here, not 'b'"));
  EXPECT_THAT(error_of("track(a=\"b"), StartsWith("chain, character 9: this double quote is not closed"));
  EXPECT_THAT(error_of("track(a=\"\\n\")"), StartsWith("chain, character 11: between double quotes"));
  EXPECT_THAT(error_of("track(=1)"), StartsWith("chain, character 7: an option's name belongs here"));
  EXPECT_THAT(error_of("track)"), StartsWith("chain, character 6: "));
  EXPECT_THAT(error_of("\x1b[31m"), HasSubstr("not '?'")) << "no control characters in messages";
}

TEST(ChainText, IsBounded) {
  EXPECT_THAT(error_of(std::string(max_chain_bytes + 1, ' ')), HasSubstr("65536 are the limit"));
  EXPECT_EQ(error_of(std::string(max_chain_bytes, ' ')), "");
  std::string units;
  for (std::size_t i = 0; i < max_chain_units; ++i) units += "a ";
  EXPECT_EQ(error_of(units), "");
  EXPECT_THAT(error_of(units + "a"), HasSubstr("at most 64 units"));
}

TEST(ChainText, WrittenAndReadAgainIsTheSame) {
  const ChainSettings chain = parse_chain(R"(a(b="x y", c=, d="\\\"", e=3) f g(h))");
  const ChainSettings again = parse_chain(chain_text(chain));
  EXPECT_EQ(chain_text(chain), R"(a(b="x y", c="", d="\\\"", e=3) f g(h=on))");
  ASSERT_EQ(again.size(), chain.size());
  for (std::size_t u = 0; u < chain.size(); ++u) {
    EXPECT_EQ(again[u].name, chain[u].name);
    ASSERT_EQ(again[u].options.size(), chain[u].options.size());
    for (std::size_t o = 0; o < chain[u].options.size(); ++o) {
      EXPECT_EQ(again[u].options[o].name, chain[u].options[o].name);
      EXPECT_EQ(again[u].options[o].value, chain[u].options[o].value);
    }
  }
}

// Any input is parsed, or refused with a position; a parsed chain can be written and parses to the same chain.
TEST(ChainText, TakesAnyBytes) {
  const unsigned seed = std::random_device{}();
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const std::string pieces = "track()=,\"\\ \n a-_9\x01\xff";
  const std::string good = R"(trace(file="a b", level=3) track driver)";
  int read = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text = round % 2 == 0 ? good : "";
    for (unsigned changes = random() % 12; changes > 0; --changes) {
      const char c = pieces[random() % pieces.size()];
      const std::size_t place = text.empty() ? 0 : random() % text.size();
      switch (random() % 3) {
        case 0:
          text.insert(place, 1, c);
          break;
        case 1:
          if (!text.empty()) text[place] = c;
          break;
        default:
          if (!text.empty()) text.erase(place, 1 + random() % 3);
      }
    }
    try {
      const std::string once = chain_text(parse_chain(text));
      EXPECT_EQ(chain_text(parse_chain(once)), once) << text;
      ++read;
    } catch (const ChainError& error) {
      EXPECT_THAT(error.what(), StartsWith("chain, character ")) << text;
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_LT(read, 19900);
}

TEST(ChainJson, NamesUnitsWithTheirOptions) {
  const ChainSettings chain = parse_chain_json(
      R"({"chain": ["track", {"unit": "trace", "file": "a b.ust", "level": 3, "quiet": true, "x": 0.5}, "driver"]})",
      "c.json");
  EXPECT_EQ(chain_text(chain), R"(track trace(file="a b.ust", level=3, quiet=on, x=0.5) driver)");
  EXPECT_EQ(chain[1].where, "c.json, chain[1]");
  EXPECT_EQ(chain[1].options[1].where, "c.json, chain[1].level");
}

TEST(ChainJson, ErrorsNameThePlaceAndTheForm) {
  EXPECT_THAT(json_error_of("{\"chain\": [}"), StartsWith("c.json, byte 12: this is not JSON"));
  EXPECT_THAT(json_error_of(""), HasSubstr("this is not JSON"));
  EXPECT_THAT(json_error_of("[]"), HasSubstr("no list named \"chain\""));
  EXPECT_THAT(json_error_of(R"({"chain": 3})"), HasSubstr("no list named \"chain\""));
  EXPECT_THAT(json_error_of(R"({"chain": [], "chian": []})"), HasSubstr("\"chian\" means nothing here"));
  EXPECT_THAT(json_error_of(R"({"chain": ["track", 3]})"), StartsWith("c.json, chain[1]: a unit is \"name\""));
  EXPECT_THAT(json_error_of(R"({"chain": [{"file": "x"}]})"), StartsWith("c.json, chain[0]: a unit is"));
  EXPECT_THAT(json_error_of(R"({"chain": [{"unit": "a", "b": [1]}]})"),
              StartsWith("c.json, chain[0].b: an option's value is text"));
  EXPECT_THAT(json_error_of(std::string(max_chain_bytes + 1, ' ')), HasSubstr("65536 are the limit"));
  EXPECT_THAT(json_error_of(std::string(max_chain_bytes, '[')), HasSubstr("this is not JSON"))
      << "depth costs no stack";
  std::string units;
  for (std::size_t i = 0; i <= max_chain_units; ++i) units += std::string(i > 0 ? "," : "") + "\"a\"";
  EXPECT_THAT(json_error_of("{\"chain\": [" + units + "]}"), HasSubstr("at most 64 units"));
}

TEST(ChainJson, TakesAnyBytes) {
  const unsigned seed = std::random_device{}();
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const std::string good = R"({"chain": ["track", {"unit": "trace", "file": "a.ust", "level": 3}, "driver"]})";
  const std::string pieces = "{}[]:,\"\\019.e-tfn \x80";
  int read = 0;
  for (int round = 0; round < 5000; ++round) {
    std::string text = good;
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes)
      text[random() % text.size()] = pieces[random() % pieces.size()];
    try {
      parse_chain_json(text, "c.json");
      ++read;
    } catch (const ChainError& error) {
      EXPECT_THAT(error.what(), StartsWith("c.json")) << text;
    }
  }
  EXPECT_GT(read, 10);
}

TEST(ChainJson, FilesThatCannotBeReadAreNamed) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "chain-json-test";
  std::filesystem::create_directories(folder);
  const auto error = [](const std::string& path) -> std::string {
    try {
      read_chain_file(path);
    } catch (const ChainError& trouble) {
      return trouble.what();
    }
    return "";
  };
  EXPECT_THAT(error(folder / "none.json"), HasSubstr("none.json: cannot read this chain file: No such file"));
  EXPECT_THAT(error(folder), HasSubstr("is a folder"));
  std::ofstream(folder / "large.json") << std::string(2 * max_chain_bytes, ' ');
  EXPECT_THAT(error(folder / "large.json"), HasSubstr("65536 are the limit"));
  std::ofstream(folder / "good.json") << R"({"chain": ["driver"]})";
  EXPECT_EQ(error(folder / "good.json"), "");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace understudy::spu
