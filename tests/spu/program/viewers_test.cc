// SPDX-License-Identifier: Apache-2.0
// Shaders in actual use: those of the bundled viewer, extracted from its sources.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include "spu/volume/program/slices.h"
#include "tests/spu/program/shader_facts.h"

namespace understudy::spu::program::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::IsEmpty;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The raw strings, R"( to )", that contain a main function.
std::vector<std::string> shaders_in(const fs::path& path) {
  static const std::regex literal(R"re(R"\(([^]*?)\)")re");
  const std::string text = contents(path);
  std::vector<std::string> shaders;
  for (std::sregex_iterator match(text.begin(), text.end(), literal), end; match != end; ++match) {
    if ((*match)[1].str().find("void main") != std::string::npos) shaders.push_back((*match)[1]);
  }
  return shaders;
}

fs::path mode(const std::string& name) {
  return fs::path(UNDERSTUDY_SOURCE_DIR) / "apps/viewer/modes" / (name + ".cc");
}

SliceFinding finding_of(const std::string& name) {
  for (const std::string& shader : shaders_in(mode(name))) {
    if (shader.find("sampler3D") == std::string::npos) continue;
    const StageFacts facts = facts_of(shader);
    std::vector<std::string> volumes;
    for (const Fetch& fetch : facts.fetches) {
      if (fetch.type.shape == TextureShape::space) volumes.push_back(fetch.sampler);
    }
    return slice_finding(facts, volumes);
  }
  ADD_FAILURE() << name << " has no shader that reads a volume";
  return {};
}

TEST(BundledViewer, HasShadersThatAreAllRead) {
  int read = 0;
  for (const auto& entry : fs::directory_iterator(mode("lit").parent_path())) {
    for (const std::string& shader : shaders_in(entry.path())) {
      facts_of(shader, shader.find("gl_Position") == std::string::npos ? Stage::fragment : Stage::vertex);
      ++read;
    }
  }
  EXPECT_GE(read, 5);
}

TEST(BundledViewer, SlicesByFunctionsOfTheSample) {
  for (const char* name : {"table_slices", "core"}) {
    const SliceFinding finding = finding_of(name);
    EXPECT_TRUE(finding.of_one_texel()) << name;
    EXPECT_THAT(finding.reasons, IsEmpty()) << name;
    EXPECT_TRUE(finding.coordinate_is_varying) << name;
  }
}

TEST(BundledViewer, LightsByFurtherTexels) {
  const SliceFinding finding = finding_of("lit");
  EXPECT_EQ(finding.texels.size(), 7U);
  EXPECT_THAT(finding.reasons, Contains("colours depend on a second texel of 'volume' at an offset"));
}

TEST(BundledViewer, IntegratesSegmentsBetweenTwoCoordinates) {
  const SliceFinding finding = finding_of("preintegrated");
  EXPECT_EQ(finding.texels.size(), 2U);
  EXPECT_TRUE(finding.others.empty());
}

}  // namespace
}  // namespace understudy::spu::program::testing
