// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/remote_seeds.h"

#include <array>
#include <string>

#include "compositor/relay/jpeg.h"
#include "compositor/transport/tcp/block_codec.h"
#include "tests/fuzz/record_input.h"
#include "tests/fuzz/remote_input.h"

namespace understudy::spu::testing {
namespace {

using compositor::MessageType;
using SeedBuffer = std::vector<std::byte>;

template <class Plain>
void append(SeedBuffer& to, std::span<const Plain> values) {
  const auto bytes = std::as_bytes(values);
  to.insert(to.end(), bytes.begin(), bytes.end());
}

SeedBuffer travelling(MessageType type, const SeedBuffer& payload, compositor::Codec codec) {
  compositor::MessageHeader header;
  header.type = type;
  header.payload_bytes = payload.size();
  SeedBuffer bytes;
  append(bytes, std::span<const compositor::MessageHeader>(&header, 1));
  if (payload.empty()) return bytes;
  SeedBuffer compressed;
  compositor::BlockCompressor compressor;
  if (codec == compositor::Codec::none || !compressor.compress(codec, payload, compressed)) {
    codec = compositor::Codec::none;
    compressed = payload;
  }
  const auto head = compositor::BlockHead::of(payload.size(), compressed.size(), codec);
  append(bytes, std::span<const compositor::BlockHead>(&head, 1));
  append(bytes, std::span<const std::byte>(compressed));
  return bytes;
}

SeedBuffer between_application_and_gl_server(MessageType type, const SeedBuffer& payload) {
  const auto message = type.as<GlServerMessage>();
  const std::array<std::uint32_t, 2> head = {message ? std::uint32_t(*message) : 0,
                                             std::uint32_t(payload.size())};
  SeedBuffer bytes;
  append(bytes, std::span<const std::uint32_t>(head));
  append(bytes, std::span<const std::byte>(payload));
  return bytes;
}

SeedBuffer some_calls() {
  const std::array<std::uint64_t, 6> records = {std::uint64_t(3) << 32 | 7, 1, 2,
                                                std::uint64_t(3) << 32 | 9, 3, 4};
  ChunkSender sender;
  sender.add(records, {});
  const CallsHead head{1, ServerReply::answer, records.size(), 0};
  SeedBuffer bytes;
  append(bytes, std::span<const CallsHead>(&head, 1));
  const std::uint64_t count = sender.heads().size();
  append(bytes, std::span<const std::uint64_t>(&count, 1));
  append(bytes, sender.heads());
  append(bytes, sender.data());
  return bytes;
}

SeedBuffer some_image(PixelCoding coding) {
  const ImageChange change{.drawable = 3, .extent = {40, 30}, .x = 4, .y = 5, .width = 16, .height = 16};
  SeedBuffer bytes;
  append(bytes, std::span<const PixelCoding>(&coding, 1));
  const SeedBuffer head = encode_head(change);
  append(bytes, std::span<const std::byte>(head));
  const SeedBuffer pixels(std::size_t(16) * 16 * 4, std::byte(90));
  if (coding == PixelCoding::jpeg)
    compositor::append_jpeg(pixels, 16, 16, compositor::JpegPixels::bgrx, 50, bytes);
  else
    append(bytes, std::span<const std::byte>(pixels));
  return bytes;
}

SeedBuffer some_rendered(compositor::ImageCoding coding) {
  const SeedBuffer reply = compositor::encode(compositor::RenderedReply{{1, 2, 20, 13}, {}});
  const std::array<std::uint32_t, 2> head = {std::uint32_t(reply.size()), std::uint32_t(coding)};
  SeedBuffer bytes;
  append(bytes, std::span<const std::uint32_t>(head));
  append(bytes, std::span<const std::byte>(reply));
  const std::vector<float> pixels(std::size_t(4) * 20 * 13, 0.25F);
  compositor::encode_image(pixels, 20, coding, compositor::Layout::rgba32f, 50, bytes);
  return bytes;
}

}  // namespace

Seeds remote_seeds() {
  using compositor::Codec;
  using compositor::ImageCoding;
  Seeds seeds;
  const std::array<std::byte, 16> contents{};
  const compositor::Credentials secret{compositor::Secret(contents)};
  compositor::ClientHandshake client(secret, {});
  compositor::ServerHandshake server(secret);
  SeedBuffer of_client = client.hello();
  server.answer(std::span(of_client).first(compositor::hello_bytes));
  SeedBuffer of_server = server.answer(std::span(of_client).subspan(compositor::hello_bytes));
  const SeedBuffer proof = client.answer(of_server);
  append(of_client, std::span<const std::byte>(proof));
  server.answer(proof);
  const SeedBuffer verdict = server.verdict(compositor::AdmissionVerdict::accepted);
  append(of_server, std::span<const std::byte>(verdict));
  seeds["client"] = of_client;
  seeds["server"] = of_server;
  for (const Codec codec : {Codec::none, Codec::lz4, Codec::zstd}) {
    const std::string name = std::to_string(int(codec));
    for (const ImageCoding coding : {ImageCoding::floats, ImageCoding::packed, ImageCoding::jpeg})
      seeds["rendered_" + std::to_string(int(coding)) + "_" + name] =
          travelling(compositor::NodeMessage::rendered, some_rendered(coding), codec);
    seeds["calls_" + name] = travelling(GlServerMessage::calls, some_calls(), codec);
    seeds["image_" + name] = travelling(GlServerMessage::image, some_image(PixelCoding::jpeg), codec);
  }
  return seeds;
}

Seeds record_seeds() {
  Seeds seeds;
  for (const std::size_t size : {0UL, 1UL, 300UL, 20'000UL}) {
    compositor::RecordSealer sealer(fuzzed_key);
    SeedBuffer line;
    for (int record = 0; record < 3; ++record)
      append(line, sealer.seal(SeedBuffer(size / std::size_t(record + 1), std::byte(record))));
    seeds[std::to_string(size)] = line;
  }
  return seeds;
}

Seeds gl_server_seeds() {
  SeedBuffer both = between_application_and_gl_server(GlServerMessage::calls, some_calls());
  const SeedBuffer again = both;
  append(both, std::span<const std::byte>(again));
  CallAnswer answer{.result = 42};
  answer.outputs.push_back({1, std::nullopt, SeedBuffer(5, std::byte(7))});
  return {
      {"calls", both},
      {"plain", between_application_and_gl_server(GlServerMessage::image, some_image(PixelCoding::plain))},
      {"jpeg", between_application_and_gl_server(GlServerMessage::refined, some_image(PixelCoding::jpeg))},
      {"accepted", between_application_and_gl_server(compositor::LauncherMessage::accepted,
                                                     encode(GlServerVersions{450, 310}))},
      {"answered", between_application_and_gl_server(GlServerMessage::answered, encode(answer))},
  };
}

}  // namespace understudy::spu::testing
