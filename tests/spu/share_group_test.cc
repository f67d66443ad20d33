// SPDX-License-Identifier: Apache-2.0
// State that is kept for all contexts of a share group.
#include "spu/track/share_group.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "volume/texel_box.h"

namespace understudy::spu {
namespace {

using ::testing::ElementsAre;

TEST(ShareGroup, AVersionNeverComesBack) {
  ShareGroup group;
  group.volume_defined();
  group.texture_changed(7);
  const auto first = group.texture_version(7);
  group.texture_changed(7);
  const auto second = group.texture_version(7);
  EXPECT_GT(second, first);
  group.some_texture_changed();
  EXPECT_GT(group.texture_version(7), second);
  const auto last = group.texture_version(7);
  group.texture_deleted(7);
  group.some_texture_changed();
  EXPECT_GT(group.texture_version(7), last);
  group.texture_changed(7);
  EXPECT_GT(group.texture_version(7), last + 1);
}

TEST(ShareGroup, TellsWhichTexelsChangedSinceAVersion) {
  using volume::TexelBox;
  ShareGroup group;
  group.volume_defined();
  EXPECT_NE(group.identity(7), 0U);
  const auto first = group.texture_version(7);
  const TexelBox corner{{0, 0, 0}, {4, 4, 4}}, other{{20, 0, 0}, {24, 4, 4}};
  group.texture_changed(7, corner);
  const auto second = group.texture_version(7);
  EXPECT_GT(second, first);
  group.texture_changed(7, other);
  EXPECT_THAT(*group.changes_since(7, first), ElementsAre(corner, other));
  EXPECT_THAT(*group.changes_since(7, second), ElementsAre(other));
  EXPECT_TRUE(group.changes_since(7, group.texture_version(7))->empty());
  group.texture_changed(7);
  EXPECT_FALSE(group.changes_since(7, second)) << "all of it may have changed";
  const auto whole = group.texture_version(7);
  group.texture_changed(7, corner);
  EXPECT_THAT(*group.changes_since(7, whole), ElementsAre(corner));
  group.some_texture_changed();
  EXPECT_FALSE(group.changes_since(7, whole));
  EXPECT_FALSE(group.changes_since(8, whole)) << "nothing is known of it";
}

TEST(ShareGroup, KeepsFewBoxesHoweverManyChangesThereAre) {
  using volume::TexelBox;
  ShareGroup group;
  const auto before = group.texture_version(7);
  for (int z = 0; z < 200; ++z) group.texture_changed(7, {{0, 0, z}, {64, 64, z + 1}});
  EXPECT_THAT(*group.changes_since(7, before), ElementsAre(TexelBox{{0, 0, 0}, {64, 64, 200}}))
      << "slices in a row are one segment";
  // Boxes far apart: the oldest are merged, while a reader that has seen these still gets the latest exactly.
  std::uint64_t seen = 0;
  for (int i = 0; i < 100; ++i) {
    seen = group.texture_version(7);
    group.texture_changed(7, {{4 * i, 0, 0}, {4 * i + 1, 1, 1}});
  }
  EXPECT_THAT(*group.changes_since(7, seen), ElementsAre(TexelBox{{396, 0, 0}, {397, 1, 1}}));
  const auto all = *group.changes_since(7, before);
  EXPECT_LE(all.size(), 16U);
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const TexelBox& box) {
      return box.low[0] <= 4 * i && box.high[0] > 4 * i;
    })) << i;
  }
}

TEST(ShareGroup, HasVolumesWhileAnyContextWatchesForStacks) {
  ShareGroup group;
  EXPECT_FALSE(group.has_volumes());
  group.stacks_watched();
  group.stacks_watched();
  group.stacks_left();
  EXPECT_TRUE(group.has_volumes());
  group.stacks_left();
  EXPECT_FALSE(group.has_volumes());
  group.stacks_watched();
  group.volume_defined();
  group.stacks_left();
  EXPECT_TRUE(group.has_volumes()) << "a 3-D texture is for good";
}

TEST(ShareGroup, ListsAreDeletedUpToTheLastName) {
  ShareGroup group;
  group.list_defined(5, {});
  group.list_defined(7, {});
  group.lists_deleted(0xffffffff, 1);
  EXPECT_TRUE(group.list(5) && group.list(7)) << "a name that no list has";
  group.lists_deleted(6, 0x7fffffff);
  EXPECT_TRUE(group.list(5));
  EXPECT_FALSE(group.list(7));
  group.lists_deleted(0, -1);
  EXPECT_TRUE(group.list(5));
}

TEST(ShareGroup, ADeletedTextureIsForgotten) {
  ShareGroup group;
  const auto first = group.identity(3);
  group.texture_rendered_to(3);
  EXPECT_EQ(group.identity(3), first);
  EXPECT_TRUE(group.is(3, first));
  EXPECT_TRUE(group.is_rendered_to(3));
  const auto deletions = group.deletions();
  group.texture_deleted(3);
  EXPECT_FALSE(group.is(3, first));
  EXPECT_NE(group.identity(3), first) << "another texture of this name";
  EXPECT_FALSE(group.is(3, first));
  EXPECT_FALSE(group.is_rendered_to(3));
  EXPECT_GT(group.deletions(), deletions);
}

TEST(ShareGroup, DeletingWhatNobodyKnowsChangesNothing) {
  ShareGroup group;
  const auto deletions = group.deletions();
  group.texture_deleted(3);
  group.texture_rendered_to(4);
  group.texture_deleted(3);
  group.texture_deleted(0);
  EXPECT_EQ(group.deletions(), deletions);
  EXPECT_TRUE(group.is_rendered_to(4));
}

TEST(ShareGroup, TellsOnceListsMayChangeTextures) {
  ShareGroup group;
  group.list_defined(1, {.draws = true});
  EXPECT_FALSE(group.lists_change_textures());
  group.list_defined(2, {.only_geometry = false, .changes_textures = true});
  EXPECT_TRUE(group.lists_change_textures());
  group.lists_deleted(1, 2);
  EXPECT_FALSE(group.list(1));
  EXPECT_FALSE(group.list(2));
}

/// A program of one vertex shader and one fragment shader, not yet linked.
class Sources : public ::testing::Test {
 protected:
  static constexpr GLuint vertex = 1;
  static constexpr GLuint fragment = 2;
  static constexpr GLuint program = 3;

  Sources() {
    given(vertex, GL_VERTEX_SHADER, "vertex text");
    given(fragment, GL_FRAGMENT_SHADER, "fragment text");
    kept.program_created(program);
    kept.shader_attached(program, vertex);
    kept.shader_attached(program, fragment);
  }

  void given(GLuint shader, GLenum type, const char* text) {
    kept.shader_created(shader, type);
    kept.source_given(shader, text);
    kept.shader_compiled(shader);
  }

  ProgramSources kept;
};

TEST_F(Sources, AreThoseOfTheLink) {
  EXPECT_EQ(kept.program(program), nullptr);
  kept.program_linked(program);
  kept.source_given(fragment, "later text");
  kept.shader_compiled(fragment);
  const auto record = kept.program(program);
  ASSERT_NE(record, nullptr);
  EXPECT_THAT(record->vertex_sources, ElementsAre("vertex text"));
  EXPECT_THAT(record->fragment_sources, ElementsAre("fragment text"));
  EXPECT_TRUE(record->vertex_shader);
  EXPECT_TRUE(record->fragment_source_known);
  EXPECT_FALSE(record->other_shader_stages);
  kept.program_linked(program);
  EXPECT_THAT(kept.program(program)->fragment_sources, ElementsAre("later text"));
  EXPECT_NE(kept.program(program)->link, record->link);
  EXPECT_THAT(record->fragment_sources, ElementsAre("fragment text")) << "what is held stays as it was";
}

TEST_F(Sources, AreWhatWasCompiledNotWhatWasGiven) {
  kept.source_given(fragment, "never compiled");
  kept.program_linked(program);
  EXPECT_THAT(kept.program(program)->fragment_sources, ElementsAre("fragment text"));
}

TEST_F(Sources, OutliveShadersThatAreDetachedAndDeleted) {
  kept.program_linked(program);
  for (const GLuint shader : {vertex, fragment}) {
    kept.shader_detached(program, shader);
    kept.shader_deleted(shader);
  }
  EXPECT_THAT(kept.program(program)->fragment_sources, ElementsAre("fragment text"));
  kept.program_linked(program);
  EXPECT_FALSE(kept.program(program)->fragment_source_known) << "nothing is attached any more";
}

TEST_F(Sources, OfAShaderDeletedWhileAttachedAreLinked) {
  kept.shader_deleted(vertex);
  kept.shader_deleted(fragment);
  kept.program_linked(program);
  EXPECT_THAT(kept.program(program)->vertex_sources, ElementsAre("vertex text"));
  kept.program_deleted(program);
  EXPECT_EQ(kept.program(program), nullptr);
  // The names are free and now denote other shaders.
  given(fragment, GL_FRAGMENT_SHADER, "another");
  kept.program_created(program);
  kept.shader_attached(program, fragment);
  kept.program_linked(program);
  EXPECT_THAT(kept.program(program)->fragment_sources, ElementsAre("another"));
}

TEST_F(Sources, OfBinariesAreNotKnown) {
  kept.binary_given(fragment);
  kept.program_linked(program);
  EXPECT_FALSE(kept.program(program)->fragment_source_known);
  kept.shader_compiled(fragment);
  kept.program_linked(program);
  EXPECT_TRUE(kept.program(program)->fragment_source_known);
  const std::array<std::byte, 3> binary{std::byte{7}, std::byte{1}, std::byte{9}};
  kept.program_loaded(program, binary);
  EXPECT_FALSE(kept.program(program)->fragment_source_known);
  EXPECT_THAT(kept.program(program)->vertex_sources, ElementsAre());
}

TEST_F(Sources, OfBinariesThatThisProcessTookAreTheProgramsOwn) {
  const std::array<std::byte, 3> binary{std::byte{7}, std::byte{1}, std::byte{9}};
  kept.program_linked(program);
  EXPECT_FALSE(kept.knows_binary(binary));
  kept.binary_taken(program, binary);
  EXPECT_TRUE(kept.knows_binary(binary));
  kept.program_created(20);
  kept.program_loaded(20, binary);
  EXPECT_TRUE(kept.program(20)->fragment_source_known);
  EXPECT_NE(kept.program(20)->link, kept.program(program)->link);
}

TEST_F(Sources, OfStagesBesideVertexAndFragmentAreOnlyNoted) {
  given(9, GL_GEOMETRY_SHADER, "geometry text");
  kept.shader_attached(program, 9);
  kept.program_linked(program);
  EXPECT_TRUE(kept.program(program)->other_shader_stages);
}

TEST_F(Sources, OfAProgramMadeInOneCallAreIts) {
  kept.program_linked_from(12, GL_FRAGMENT_SHADER, "alone");
  EXPECT_THAT(kept.program(12)->fragment_sources, ElementsAre("alone"));
  EXPECT_FALSE(kept.program(12)->vertex_shader);
}

TEST(JoinedSource, FollowsTheLengths) {
  const std::array<const char*, 3> strings = {"one ", "two cut here", "three"};
  const std::array<GLint, 3> lengths = {-1, 4, 5};
  EXPECT_EQ(joined(3, strings.data(), lengths.data()), "one two three");
  EXPECT_EQ(joined(1, strings.data(), nullptr), "one ");
  EXPECT_EQ(joined(0, nullptr, nullptr), "");
  EXPECT_EQ(joined(2, nullptr, nullptr), "");
}

}  // namespace
}  // namespace understudy::spu
