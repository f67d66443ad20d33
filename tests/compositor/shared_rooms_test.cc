#include "compositor/exchange/shared_rooms.h"

#include <gtest/gtest.h>
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
  for (int rank = 0; rank < ranks; ++rank) memories.push_back(SharedRooms::make_memory());
  return memories;
}

std::size_t resident_bytes(const FileDescriptor& memory) {
  struct stat status {};
  ::fstat(memory.get(), &status);
  return 512 * std::size_t(status.st_blocks);
}

TEST(SharedRooms, WhatOneRankWritesAnotherReads) {
  const std::vector<FileDescriptor> memories = memories_of(2);
  SharedRooms zero(memories, 0), one(memories, 1);
  constexpr std::string_view first = "behind", second = "in front";
  for (const std::string_view text : {first, second}) {
    const std::span<std::byte> room = one.room(text.size());
    ASSERT_EQ(room.size(), text.size());
    std::memcpy(room.data(), text.data(), text.size());
    const auto place = one.place_of(room);
    ASSERT_TRUE(place);
    const std::span<const std::byte> seen = zero.at(1, *place);
    EXPECT_EQ(std::string_view(reinterpret_cast<const char*>(seen.data()), seen.size()), text);
  }
}

TEST(SharedRooms, OnlyOwnRoomsHaveAPlace) {
  const std::vector<FileDescriptor> memories = memories_of(2);
  SharedRooms zero(memories, 0), one(memories, 1);
  const std::vector<std::byte> elsewhere(100);
  EXPECT_FALSE(zero.place_of(elsewhere));
  EXPECT_FALSE(zero.place_of(one.room(100)));
}

TEST(SharedRooms, GivesNoMoreThanThereIsAndTakesPagesWhenTheyAreWritten) {
  const std::vector<FileDescriptor> memories = memories_of(1);
  SharedRooms rooms(memories, 0);
  EXPECT_TRUE(rooms.room(SharedRooms::most_bytes + 1).empty());
  EXPECT_EQ(rooms.room(SharedRooms::most_bytes - 1000).size(), SharedRooms::most_bytes - 1000);
  EXPECT_TRUE(rooms.room(2000).empty());
  EXPECT_EQ(rooms.room(900).size(), 900U);
  EXPECT_TRUE(rooms.room(100).empty());
  EXPECT_EQ(resident_bytes(memories[0]), 0U);
  rooms.clear();
  const std::span<std::byte> room = rooms.room(100'000);
  std::ranges::fill(room, std::byte(1));
  EXPECT_LT(resident_bytes(memories[0]), 200'000U);
}

TEST(SharedRooms, PlacesOutsideOfTheMemoryAreRefused) {
  const std::vector<FileDescriptor> memories = memories_of(2);
  SharedRooms rooms(memories, 0);
  EXPECT_THROW(rooms.at(1, {SharedRooms::most_bytes + 1, 0}), LinkLost);
  EXPECT_THROW(rooms.at(1, {SharedRooms::most_bytes - 10, 11}), LinkLost);
  EXPECT_THROW(rooms.at(1, {16, ~std::uint64_t(0)}), LinkLost);
  EXPECT_EQ(rooms.at(1, {SharedRooms::most_bytes - 10, 10}).size(), 10U);
}

}  // namespace
}  // namespace understudy::compositor
