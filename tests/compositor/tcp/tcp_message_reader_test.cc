// SPDX-License-Identifier: Apache-2.0
// Messages over TCP arrive as they were sent, in pieces of any size, and malformed ones are refused.
#include "compositor/transport/tcp/tcp_message_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>

#include "compositor/relay/jpeg.h"
#include "compositor/relay/render_relay.h"
#include "compositor/service/limits.h"
#include "compositor/service/service_protocols.h"
#include "compositor/transport/tcp/block_codec.h"

namespace understudy::compositor {
namespace {

using Buffer = std::vector<std::byte>;

Buffer noise(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  Buffer bytes(size);
  for (std::byte& byte : bytes) byte = std::byte(random());
  return bytes;
}

/// Like texels: similar to their neighbours.
Buffer smooth(std::size_t size) {
  Buffer bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = std::byte((i / 300) & 0xff);
  return bytes;
}

void append(Buffer& to, std::span<const std::byte> bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// Returns a message as it is sent, in blocks of at most `block_bytes`.
Buffer travelling(MessageType type, std::span<const std::byte> payload, Codec codec, std::size_t block_bytes) {
  MessageHeader header;
  header.type = type;
  header.sequence = 12;
  header.payload_bytes = payload.size();
  Buffer bytes;
  append(bytes, std::as_bytes(std::span(&header, 1)));
  BlockCompressor compressor;
  while (!payload.empty()) {
    const auto block = payload.first(std::min(payload.size(), block_bytes));
    payload = payload.subspan(block.size());
    Buffer compressed;
    const bool shorter = codec != Codec::none && compressor.compress(codec, block, compressed);
    const auto travels = shorter ? std::span<const std::byte>(compressed) : block;
    const BlockHead head = BlockHead::of(block.size(), travels.size(), shorter ? codec : Codec::none);
    append(bytes, std::as_bytes(std::span(&head, 1)));
    append(bytes, travels);
  }
  return bytes;
}

/// Reads `bytes` in pieces of at most `most` bytes.
std::vector<Message> read(std::span<const std::byte> bytes, std::size_t most, std::uint64_t max_payload) {
  TcpMessageReader reader(service_protocols, max_payload);
  std::vector<Message> messages;
  while (!bytes.empty()) {
    const std::span<std::byte> room = reader.room();
    EXPECT_FALSE(room.empty());
    const std::size_t count = std::min({room.size(), most, bytes.size()});
    std::ranges::copy(bytes.first(count), room.begin());
    bytes = bytes.subspan(count);
    if (auto message = reader.took(count)) messages.push_back(std::move(*message));
  }
  return messages;
}

TEST(TcpMessageReader, MessagesArriveWholeWhateverPiecesTheyComeIn) {
  for (const Codec codec : {Codec::none, Codec::lz4, Codec::zstd})
    for (const std::size_t size : {0, 1, 7, 513, 99'999}) {
      const Buffer first = smooth(size);
      const Buffer second = noise(size / 2, unsigned(size));
      Buffer bytes = travelling(NodeMessage::add_texels, first, codec, 4096);
      append(bytes, travelling(NodeMessage::add_texels, second, codec, 777));
      for (const std::size_t most : {1, 13, 100'000}) {
        const auto messages = read(bytes, most, 1 << 20);
        ASSERT_EQ(messages.size(), 2U) << int(codec) << " " << size << " " << most;
        EXPECT_EQ(messages[0].payload, first);
        EXPECT_EQ(messages[0].sequence, 12U);
        EXPECT_EQ(messages[1].payload, second);
        EXPECT_EQ(messages[1].type, NodeMessage::add_texels);
      }
    }
  EXPECT_LT(travelling(NodeMessage::add_texels, smooth(99'999), Codec::lz4, 4096).size(), 10'000U);
}

TEST(TcpMessageReader, BlocksOfNothingAreNoPartOfAMessage) {
  const Buffer payload = noise(5000, 3);
  Buffer bytes = travelling(NodeMessage::add_texels, payload, Codec::none, 5000);
  const std::array<std::byte, sizeof(BlockHead)> nothing{};
  for (int i = 0; i < 3; ++i)
    bytes.insert(bytes.begin() + sizeof(MessageHeader), nothing.begin(), nothing.end());
  for (const std::size_t most : {1, 13, 100'000}) {
    const auto messages = read(bytes, most, 1 << 20);
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(messages[0].payload, payload);
  }
}

TEST(TcpMessageReader, NothingIsBelievedThatCannotBe) {
  const Buffer payload = smooth(3000);
  const Buffer good = travelling(NodeMessage::add_texels, payload, Codec::lz4, 1000);
  EXPECT_THROW(read(good, 64, 2999), MalformedMessage) << "longer than the limit";
  const auto with_head = [&](BlockHead head) {
    Buffer bytes = good;
    std::memcpy(bytes.data() + sizeof(MessageHeader), &head, sizeof head);
    return bytes;
  };
  EXPECT_THROW(read(with_head({0, 1}), 64, 1 << 20), MalformedMessage);
  EXPECT_THROW(read(with_head({3001, 10}), 64, 1 << 20), MalformedMessage);
  EXPECT_THROW(read(with_head(BlockHead::of(1000, 0, Codec::lz4)), 64, 1 << 20), MalformedMessage);
  EXPECT_THROW(read(with_head(BlockHead::of(1000, 1000, Codec::lz4)), 64, 1 << 20), MalformedMessage);
  EXPECT_THROW(read(with_head(BlockHead::of(1000, 999, Codec::none)), 64, 1 << 20), MalformedMessage);
  EXPECT_THROW(read(with_head(BlockHead::of(1000, 10, Codec(7))), 64, 1 << 20), MalformedMessage);
  // A change of any byte of the heads or of a compressed block causes no crash, and never a longer message.
  for (std::size_t at = 0; at < good.size(); ++at) {
    Buffer changed = good;
    changed[at] ^= std::byte(0x41);
    try {
      for (const Message& message : read(changed, 64, 1 << 20))
        EXPECT_LE(message.payload.size(), payload.size());
    } catch (const MalformedMessage&) {
      // As expected.
    }
  }
}

TEST(CodecChoice, FastLinesCarryBlocksAsTheyAreAndSlowOnesCompressed) {
  CodecChoice choice;
  EXPECT_EQ(choice.best(0), Codec::none) << "nothing known of the line";
  EXPECT_EQ(choice.best(10e9), Codec::none);
  EXPECT_NE(choice.best(10e6), Codec::none);
  EXPECT_EQ(choice.best(1e6), Codec::zstd);
  // Blocks that do not get shorter are sent unchanged, and compressed again only now and then.
  int tried = 0;
  for (int block = 0; block < 1000; ++block) {
    const Codec codec = choice.best(10e6);
    tried += codec != Codec::none;
    choice.note(codec, 100'000, 100'000, 100'000 * 1e-9);
  }
  EXPECT_GT(tried, 1);
  EXPECT_LT(tried, 200);
}

std::vector<float> some_image(int width, int height) {
  std::vector<float> pixels(4 * std::size_t(width) * std::size_t(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float* const pixel = &pixels[4 * (std::size_t(y) * std::size_t(width) + std::size_t(x))];
      const float alpha = 0.5F + 0.5F * std::sin(0.05F * float(x)) * std::cos(0.04F * float(y));
      for (int c = 0; c < 3; ++c) pixel[c] = alpha * (0.3F + 0.2F * float(c)) + 1e-4F * float(x % 7);
      pixel[3] = alpha;
    }
  return pixels;
}

TEST(ImageCoding, EachKeepsWhatItSays) {
  for (const auto& size : {std::pair(1, 1), std::pair(97, 61), std::pair(333, 5), std::pair(3, 1001)}) {
    const int width = size.first;
    const std::vector<float> image = some_image(width, size.second);
    const auto error = [&](ImageCoding coding, Layout layout, int quality) {
      Buffer bytes;
      encode_image(image, width, coding, layout, quality, bytes);
      std::vector<float> back(image.size(), -1.0F);
      decode_image(bytes, coding, layout, width, back);
      for (const std::size_t cut : {std::size_t(0), bytes.size() / 3})
        EXPECT_THROW(decode_image(std::span(bytes).first(cut), coding, layout, width, back), MalformedMessage);
      double most = 0;
      double sum = 0;
      for (std::size_t i = 0; i < back.size(); ++i) {
        const double difference = std::abs(double(back[i]) - double(image[i]));
        most = std::max(most, difference);
        sum += difference * difference;
      }
      return std::pair(most, std::sqrt(sum / double(back.size())));
    };
    EXPECT_EQ(error(ImageCoding::floats, Layout::rgba32f, 0).first, 0);
    EXPECT_EQ(error(ImageCoding::packed, Layout::rgba32f, 0).first, 0);
    EXPECT_LT(error(ImageCoding::packed, Layout::rgba16f, 0).first, 1.0 / 2048);
    EXPECT_LT(error(ImageCoding::packed, Layout::rgba8, 0).first, 1.0 / 510 + 1e-6);
    EXPECT_LT(error(ImageCoding::jpeg, Layout::rgba32f, 90).second, 0.02) << width << " x " << size.second;
  }
}

TEST(Jpeg, OtherSizesAndOtherBytesAreRefused) {
  const Buffer pixels = smooth(4 * 31 * 17);
  Buffer jpeg;
  append_jpeg(pixels, 31, 17, JpegPixels::bgrx, 80, jpeg);
  Buffer back(pixels.size());
  EXPECT_NO_THROW(read_jpeg(jpeg, 31, 17, JpegPixels::bgrx, back));
  EXPECT_THROW(read_jpeg(jpeg, 17, 31, JpegPixels::bgrx, back), MalformedMessage);
  EXPECT_THROW(read_jpeg(std::span(jpeg).first(jpeg.size() / 2), 31, 17, JpegPixels::bgrx, back),
               MalformedMessage);
  EXPECT_THROW(read_jpeg(noise(500, 3), 31, 17, JpegPixels::bgrx, back), MalformedMessage);
  EXPECT_THROW(read_jpeg({}, 31, 17, JpegPixels::bgrx, back), MalformedMessage);
}

}  // namespace
}  // namespace understudy::compositor
