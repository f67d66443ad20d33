// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/shared_segments.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

namespace understudy::compositor {
namespace {

std::vector<FileDescriptor> memories_of(int ranks) {
  std::vector<FileDescriptor> memories;
  memories.reserve(std::size_t(ranks));
  for (int rank = 0; rank < ranks; ++rank) memories.push_back(SharedSegments::make_memory());
  return memories;
}

std::size_t resident_bytes(const FileDescriptor& memory) {
  struct stat status {};
  ::fstat(memory.get(), &status);
  return 512 * std::size_t(status.st_blocks);
}

TEST(SharedSegments, WhatOneRankWritesAnotherReads) {
  const std::vector<FileDescriptor> memories = memories_of(2);
  SharedSegments zero(memories, 0), one(memories, 1);
  constexpr std::string_view first = "behind", second = "in front";
  for (const std::string_view text : {first, second}) {
    const std::span<std::byte> segment = one.segment(text.size());
    ASSERT_EQ(segment.size(), text.size());
    std::memcpy(segment.data(), text.data(), text.size());
    const auto place = one.place_of(segment);
    ASSERT_TRUE(place);
    const std::span<const std::byte> seen = zero.at(1, *place);
    EXPECT_EQ(std::string_view(reinterpret_cast<const char*>(seen.data()), seen.size()), text);
  }
}

TEST(SharedSegments, OnlyOwnSegmentsHaveAPlace) {
  const std::vector<FileDescriptor> memories = memories_of(2);
  SharedSegments zero(memories, 0), one(memories, 1);
  const std::vector<std::byte> elsewhere(100);
  EXPECT_FALSE(zero.place_of(elsewhere));
  EXPECT_FALSE(zero.place_of(one.segment(100)));
}

TEST(SharedSegments, GivesNoMoreThanThereIsAndTakesPagesWhenTheyAreWritten) {
  const std::vector<FileDescriptor> memories = memories_of(1);
  SharedSegments segments(memories, 0);
  EXPECT_TRUE(segments.segment(SharedSegments::most_bytes + 1).empty());
  EXPECT_EQ(segments.segment(SharedSegments::most_bytes - 1000).size(), SharedSegments::most_bytes - 1000);
  EXPECT_TRUE(segments.segment(2000).empty());
  EXPECT_EQ(segments.segment(900).size(), 900U);
  EXPECT_TRUE(segments.segment(100).empty());
  EXPECT_EQ(resident_bytes(memories[0]), 0U);
  segments.clear();
  const std::span<std::byte> segment = segments.segment(100'000);
  std::ranges::fill(segment, std::byte(1));
  EXPECT_LT(resident_bytes(memories[0]), 200'000U);
}

TEST(SharedSegments, AreSmallerWhereAProcessMayHaveFewAddresses) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  constexpr std::size_t addresses = std::size_t(1) << 32, of_a_rank = addresses / 64;
  const rlimit few{addresses, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &few), 0);
  const FileDescriptor small = SharedSegments::make_memory();
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  SharedSegments segments({&small, 1}, 0);
  EXPECT_TRUE(segments.segment(of_a_rank + 1).empty());
  EXPECT_EQ(segments.segment(of_a_rank).size(), of_a_rank);
  EXPECT_THROW(segments.at(0, {of_a_rank - 10, 11}), RankLost);
}

TEST(SharedSegments, PlacesOutsideOfTheMemoryAreRefused) {
  const std::vector<FileDescriptor> memories = memories_of(2);
  SharedSegments segments(memories, 0);
  EXPECT_THROW(segments.at(1, {SharedSegments::most_bytes + 1, 0}), RankLost);
  EXPECT_THROW(segments.at(1, {SharedSegments::most_bytes - 10, 11}), RankLost);
  EXPECT_THROW(segments.at(1, {16, ~std::uint64_t(0)}), RankLost);
  EXPECT_EQ(segments.at(1, {SharedSegments::most_bytes - 10, 10}).size(), 10U);
}

}  // namespace
}  // namespace understudy::compositor
