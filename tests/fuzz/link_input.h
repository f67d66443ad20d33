// How the bytes of a fuzzer, or a file of its corpus, come over a link: to both sides of the handshake, as
// messages over TCP with the pictures in them, and as what an application and a stage say to each other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

#include "compositor/tcp/handshake.h"
#include "compositor/tcp/link_reader.h"
#include "compositor/tcp/render_porter.h"
#include "spu/link/stage_protocol.h"
#include "spu/link/travelling_picture.h"
#include "spu/stream/call_answer.h"

namespace understudy::spu::testing {

/// What cannot be believed says so by an exception; anything else is a fault.
template <class Step>
bool may_refuse(Step step) {
  try {
    step();
  } catch (const std::runtime_error&) {
    return false;
  }
  return true;
}

inline void shake_hands(std::span<const std::byte> input) {
  using namespace compositor;
  const std::array<std::byte, 16> contents{};
  const Secret secret(contents);
  const auto part = [&](std::size_t from, std::size_t size) {
    from = std::min(from, input.size());
    return input.subspan(from, std::min(size, input.size() - from));
  };
  may_refuse([&] {
    ServerHandshake server(secret);
    server.answer(part(0, link_hello_bytes));
    server.answer(part(link_hello_bytes, link_proof_bytes));
  });
  may_refuse([&] {
    ClientHandshake client(secret, {});
    client.answer(part(0, link_challenge_bytes));
    client.finish(part(link_challenge_bytes, link_verdict_bytes));
  });
}

/// Whether it was believed.
inline bool take_message(const compositor::Message& message, ChunkReceiver& chunks) {
  using compositor::MessageType;
  return may_refuse([&] {
    switch (message.type) {
      case MessageType::rendered: {
        std::vector<float> memory(std::size_t(4) * 256 * 256);
        compositor::take_picture(message.payload, memory);
        break;
      }
      case MessageType::calls:
        decode_calls(message.payload, chunks);
        break;
      case MessageType::answered:
        decode_answer(message.payload);
        break;
      case MessageType::picture:
      case MessageType::refined:
        decode_picture(decode_travelling_picture(message.payload));
        break;
      case MessageType::welcome:
        decode_versions(message.payload);
        break;
      default:
        break;
    }
  });
}

/// Bytes as they come out of the socket, in pieces of any size. How many messages were believed.
inline int play_link_input(std::span<const std::byte> input) {
  shake_hands(input);
  int believed = 0;
  ChunkReceiver chunks;
  may_refuse([&] {
    compositor::LinkReader reader(std::size_t(1) << 22);
    const std::size_t most = input.empty() ? 1 : 1 + std::to_integer<std::size_t>(input.front());
    while (!input.empty()) {
      const std::span<std::byte> room = reader.room();
      const std::size_t count = std::min({room.size(), most, input.size()});
      std::ranges::copy(input.first(count), room.begin());
      input = input.subspan(count);
      if (const auto message = reader.took(count)) believed += take_message(*message, chunks);
    }
  });
  return believed;
}

/// Messages of an application and of a stage, one after the other: type and length as 32-bit words, then the
/// payload. How many messages were believed.
inline int play_stage_input(std::span<const std::byte> input) {
  int believed = 0;
  ChunkReceiver chunks;
  std::uint32_t head[2];
  while (input.size() >= sizeof head) {
    std::memcpy(head, input.data(), sizeof head);
    input = input.subspan(sizeof head);
    const auto payload = input.first(std::min<std::size_t>(head[1], input.size()));
    input = input.subspan(payload.size());
    believed +=
        take_message({compositor::MessageType(head[0] % (std::uint32_t(compositor::MessageType::last) + 1)),
                      0,
                      {payload.begin(), payload.end()},
                      {}},
                     chunks);
  }
  return believed;
}

}  // namespace understudy::spu::testing
