// SPDX-License-Identifier: Apache-2.0
// Messages between applications and GL servers arrive complete, and truncated or absurd messages are refused.
#include "spu/remote/gl_server_protocol.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "apps/understudy/gl_server/frame_changes.h"
#include "compositor/transport/wire.h"
#include "spu/stream/call_answer.h"

namespace understudy::spu {
namespace {

using compositor::MalformedMessage;

/// Encodes one message of calls, as it is transmitted.
std::vector<std::byte> calls_message(CallsHead head, std::span<const std::uint64_t> words) {
  std::vector<std::uint64_t> all(sizeof head / 8);
  std::memcpy(all.data(), &head, sizeof head);
  all.insert(all.end(), words.begin(), words.end());
  const auto bytes = std::as_bytes(std::span(all));
  return {bytes.begin(), bytes.end()};
}

std::vector<std::uint64_t> chunks_of(ChunkSender& sender, std::span<const std::uint64_t> records,
                                     std::span<const std::uint64_t> payload) {
  sender.clear();
  sender.add(records, payload);
  std::vector<std::uint64_t> words = {sender.heads().size()};
  words.insert(words.end(), sender.heads().begin(), sender.heads().end());
  words.insert(words.end(), sender.data().begin(), sender.data().end());
  return words;
}

/// Records of three words each.
std::vector<std::uint64_t> some_records(std::size_t count, std::uint64_t seed) {
  std::vector<std::uint64_t> words;
  for (std::size_t i = 0; i < count; ++i) words.insert(words.end(), {std::uint64_t(3) << 32 | 7, i, seed + i});
  return words;
}

TEST(GlServerProtocol, CallsHaveAsManyWordsAsTheySay) {
  const std::vector<std::uint64_t> records = {1, 2, 3, 4, 5};
  const std::vector<std::uint64_t> payload = {6, 7};
  ChunkSender sender;
  const auto chunks = chunks_of(sender, records, payload);
  ChunkReceiver receiver;
  const auto message = calls_message({3, ServerReply::answer, 5, 2}, chunks);
  const Calls calls = decode_calls(message, receiver);
  EXPECT_EQ(calls.head.thread, 3U);
  EXPECT_EQ(std::vector(calls.records.begin(), calls.records.end()), records);
  EXPECT_EQ(std::vector(calls.payload.begin(), calls.payload.end()), payload);
  const auto refused = [&](const CallsHead& head, std::span<const std::uint64_t> words) {
    ChunkReceiver fresh;
    EXPECT_THROW(decode_calls(calls_message(head, words), fresh), MalformedMessage);
  };
  refused({3, ServerReply::answer, 5, 1}, chunks);
  refused({3, ServerReply::answer, 6, 2}, chunks);
  refused({3, ServerReply::answer, ~std::uint64_t(0), 8}, chunks);
  refused({3, ServerReply(9), 5, 2}, chunks);
  for (std::size_t words = 0; words < chunks.size(); ++words)
    refused({3, ServerReply::answer, 5, 2}, std::span(chunks).first(words));
  // References to chunks that this receiver never got are refused.
  const auto again = chunks_of(sender, records, payload);
  EXPECT_LT(again.size(), chunks.size());
  refused({3, ServerReply::answer, 5, 2}, again);
  EXPECT_EQ(decode_calls(calls_message({3, ServerReply::answer, 5, 2}, again), receiver).records.size(), 5U);
}

TEST(Chunks, WhatIsTheSameDoesNotTravelAgain) {
  ChunkSender sender;
  ChunkReceiver receiver;
  auto records = some_records(20000, 1);
  const std::vector<std::uint64_t> payload(5000, 9);
  const auto travels = [&] {
    const auto words = chunks_of(sender, records, payload);
    const auto received = receiver.receive(words, records.size() + payload.size());
    std::vector<std::uint64_t> sent = records;
    sent.insert(sent.end(), payload.begin(), payload.end());
    EXPECT_EQ(std::vector(received.begin(), received.end()), sent);
    return words.size();
  };
  EXPECT_GT(travels(), 60000U);
  EXPECT_LT(travels(), 400U);
  records[30001] = 5;
  EXPECT_LT(travels(), 700U);
  EXPECT_LT(travels(), 400U);
  // Many times more than the slots hold: both ends still agree.
  for (std::uint64_t seed = 2; seed < 60; ++seed) {
    records = some_records(50000, seed * 1'000'000);
    EXPECT_GT(travels(), 150000U);
  }
}

TEST(GlServerProtocol, VersionsArrive) {
  const GlServerVersions versions = decode_versions(encode(GlServerVersions{450, 310}));
  EXPECT_EQ(versions.core, 450);
  EXPECT_EQ(versions.compatibility, 310);
  EXPECT_THROW(decode_versions(encode(GlServerVersions{45000, 310})), MalformedMessage);
}

std::vector<std::byte> image_message(const ImageChange& change, std::size_t pixels) {
  std::vector<std::byte> bytes = encode_head(change);
  bytes.resize(bytes.size() + pixels * 4);
  return bytes;
}

TEST(GlServerProtocol, ImagesStayWithinTheirDrawable) {
  const ImageChange change{.drawable = 5, .extent = {40, 30}, .x = 10, .y = 20, .width = 30, .height = 10};
  const auto message = image_message(change, 300);
  const ImageChange read = decode_image(message);
  EXPECT_EQ(read.extent, change.extent);
  EXPECT_EQ(read.drawable, 5U);
  EXPECT_EQ(read.x, 10);
  EXPECT_EQ(read.y, 20);
  EXPECT_EQ(read.pixels.size(), 1200U);
  EXPECT_THROW(decode_image(image_message(change, 299)), MalformedMessage);
  EXPECT_THROW(decode_image(image_message({.extent = {40, 30}, .x = 11, .width = 30, .height = 1}, 30)),
               MalformedMessage);
  EXPECT_THROW(decode_image(image_message({.extent = {40, 30}, .x = -1, .width = 3, .height = 1}, 3)),
               MalformedMessage);
  EXPECT_THROW(decode_image(image_message({.extent = {60000, 60000}}, 0)), MalformedMessage);
}

TEST(CallAnswer, ComesBackWholeOrNotAtAll) {
  CallAnswer answer{.result = 42};
  answer.outputs.push_back({1, std::nullopt, std::vector<std::byte>(5, std::byte(7))});
  answer.outputs.push_back(
      {6, ImageShape{3, 2, 1, GL_RGB, GL_UNSIGNED_BYTE, 2}, std::vector<std::byte>(18, std::byte(9))});
  const std::vector<std::byte> bytes = encode(answer);
  const auto read = decode_answer(bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->result, 42U);
  ASSERT_EQ(read->outputs.size(), 2U);
  EXPECT_EQ(read->outputs[0].bytes, answer.outputs[0].bytes);
  EXPECT_FALSE(read->outputs[0].image);
  ASSERT_TRUE(read->outputs[1].image);
  EXPECT_EQ(read->outputs[1].image->width, 3);
  EXPECT_EQ(read->outputs[1].image->format, GLenum(GL_RGB));
  EXPECT_EQ(encode(*read), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + std::ptrdiff_t(size));
    EXPECT_FALSE(decode_answer(cut)) << "cut at " << size;
  }
}

/// RGBA of every pixel, bottom row first.
std::vector<std::uint8_t> image_of(Extent2D extent, std::uint8_t value) {
  return std::vector<std::uint8_t>(std::size_t(extent.width) * std::size_t(extent.height) * 4, value);
}

TEST(FrameChanges, AreTheSmallestRectangle) {
  launcher::FrameChanges changes;
  const Extent2D extent{8, 6};
  auto image = image_of(extent, 10);
  ImageChange change = changes.next(1, extent, image);
  EXPECT_EQ(change.width, 8);
  EXPECT_EQ(change.height, 6);
  change = changes.next(1, extent, image);
  EXPECT_EQ(change.width * change.height, 0);
  // Pixels (2, 1) and (5, 3) from the lower left: rows 4 and 2 from the top.
  image[(1 * 8 + 2) * 4] = 200;
  image[(3 * 8 + 5) * 4 + 2] = 100;
  change = changes.next(1, extent, image);
  EXPECT_EQ(change.x, 2);
  EXPECT_EQ(change.y, 2);
  EXPECT_EQ(change.width, 4);
  EXPECT_EQ(change.height, 3);
  ASSERT_EQ(change.pixels.size(), 48U);
  // Blue first: the last pixel of the first row, and the first of the last row.
  EXPECT_EQ(change.pixels[3 * 4], std::byte(100));
  EXPECT_EQ(change.pixels[8 * 4 + 2], std::byte(200));
  // A different window or size has no previous image, so everything is sent.
  EXPECT_EQ(changes.next(2, extent, image).width, 8);
  EXPECT_EQ(changes.next(1, {4, 4}, image_of({4, 4}, 10)).height, 4);
}

}  // namespace
}  // namespace understudy::spu
