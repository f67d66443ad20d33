// SPDX-License-Identifier: Apache-2.0
// Feeds the bytes of a fuzzer, or a file of its corpus, to both sides of the handshake, as messages over TCP
// with images in them, and as messages between an application and a GL server.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "compositor/relay/render_relay.h"
#include "compositor/service/service_protocols.h"
#include "compositor/transport/tcp/handshake.h"
#include "compositor/transport/tcp/tcp_message_reader.h"
#include "spu/remote/gl_server_protocol.h"
#include "spu/remote/travelling_image.h"
#include "spu/stream/call_answer.h"

namespace understudy::spu::testing {

/// Input may be refused by a std::runtime_error; anything else is a fault.
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
  const Credentials secret{Secret(contents)};
  const auto part = [&](std::size_t from, std::size_t size) {
    from = std::min(from, input.size());
    return input.subspan(from, std::min(size, input.size() - from));
  };
  may_refuse([&] {
    ServerHandshake server(secret);
    server.answer(part(0, hello_bytes));
    server.answer(part(hello_bytes, client_key_bytes));
    server.answer(part(hello_bytes + client_key_bytes, proof_bytes));
  });
  may_refuse([&] {
    ClientHandshake client(secret, {});
    client.answer(part(0, challenge_bytes + server_key_bytes));
    client.finish(part(challenge_bytes + server_key_bytes, verdict_bytes));
  });
}

/// Returns whether the message was accepted. `chunks` is large, and is created for the first message that needs
/// it.
inline bool take_message(const compositor::Message& message, std::optional<ChunkReceiver>& chunks) {
  return may_refuse([&] {
    if (message.type == compositor::NodeMessage::rendered) {
      std::vector<float> memory(std::size_t(4) * 64 * 64);
      compositor::take_image(message.payload, memory);
    } else if (message.type == GlServerMessage::calls) {
      if (!chunks) chunks.emplace();
      decode_calls(message.payload, *chunks);
    } else if (message.type == GlServerMessage::answered) {
      decode_answer(message.payload);
    } else if (message.type == GlServerMessage::image || message.type == GlServerMessage::refined) {
      decode_image(decode_travelling_image(message.payload));
    } else if (message.type == compositor::LauncherMessage::accepted) {
      decode_versions(message.payload);
    }
  });
}

/// All protocols over TCP, of nodes and of GL servers.
inline constexpr std::array all_protocols{
    compositor::protocol_of(compositor::LauncherMessage{}), compositor::protocol_of(compositor::NodeMessage{}),
    compositor::protocol_of(compositor::LoadMessage{}), protocol_of(GlServerMessage{})};

/// Bytes as received from a socket, in pieces of any size. Returns the number of accepted messages.
inline int play_remote_input(std::span<const std::byte> input) {
  shake_hands(input);
  int believed = 0;
  std::optional<ChunkReceiver> chunks;
  may_refuse([&] {
    // A larger limit would only add zeros, which a compressed block encodes in a few bytes and which take 10 ms
    // to write.
    compositor::TcpMessageReader reader(all_protocols, std::size_t(1) << 18);
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

/// Messages of an application and a GL server, one after the other: type (0: LauncherMessage::accepted) and
/// length as 32-bit words, then the payload. Returns the number of accepted messages.
inline int play_gl_server_input(std::span<const std::byte> input) {
  int believed = 0;
  std::optional<ChunkReceiver> chunks;
  std::uint32_t head[2];
  while (input.size() >= sizeof head) {
    std::memcpy(head, input.data(), sizeof head);
    input = input.subspan(sizeof head);
    const auto payload = input.first(std::min<std::size_t>(head[1], input.size()));
    input = input.subspan(payload.size());
    compositor::Message message{.payload = {payload.begin(), payload.end()}};
    message.type = head[0] == 0 ? compositor::MessageType(compositor::LauncherMessage::accepted)
                                : GlServerMessage(head[0] % (std::uint32_t(GlServerMessage::last) + 1));
    believed += take_message(message, chunks);
  }
  return believed;
}

}  // namespace understudy::spu::testing
