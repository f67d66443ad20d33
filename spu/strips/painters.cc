#include "spu/strips/painters.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <exception>
#include <utility>

#include "compositor/service/limits.h"
#include "compositor/service/socket.h"
#include "spu/link/stage_protocol.h"
#include "spu/report/counters.h"

namespace understudy::spu {
namespace {

using compositor::Clock;
using compositor::MalformedMessage;
using compositor::Message;
using compositor::MessageType;
namespace limits = compositor::limits;

/// Painters are to be at work while the application still calls.
constexpr std::size_t many_words = 4096;

}  // namespace

std::vector<std::byte> encode(const PainterPlace& place) {
  const std::array<std::uint64_t, 2> words = {std::uint64_t(place.part), std::uint64_t(place.parts)};
  const auto bytes = std::as_bytes(std::span(words));
  return {bytes.begin(), bytes.end()};
}

PainterPlace decode_painter_place(std::span<const std::byte> payload) {
  std::array<std::uint64_t, 2> words{};
  if (payload.size() != sizeof words) throw MalformedMessage("its hello is no painter's");
  std::memcpy(words.data(), payload.data(), sizeof words);
  if (words[1] > most_strips || words[0] == 0 || words[0] >= words[1])
    throw MalformedMessage("its hello names a strip that there is not");
  return {int(words[0]), int(words[1])};
}

void Painters::gather(int parts) {
  if (std::exchange(gathered_, true)) return;
  try {
    for (int part = 1; part < parts; ++part) {
      const auto until = Clock::now() + limits::hello_patience;
      auto painter = std::make_unique<Painter>(Painter{
          compositor::Connection(compositor::connect_to(socket_, until), limits::max_stage_message_bytes), {}});
      painter->connection.send(MessageType::hello_client, 0, encode(PainterPlace{part, parts}), until);
      painters_.push_back(std::move(painter));
    }
    // They start at the same time.
    for (const auto& painter : painters_) {
      const Message welcome = painter->connection.receive(Clock::now() + limits::stage_patience);
      if (welcome.type == MessageType::refused)
        throw std::runtime_error(compositor::decode_text(welcome.payload));
      if (welcome.type != MessageType::welcome) throw MalformedMessage("its first message is no welcome");
    }
    process_counters().strips.count = std::uint32_t(parts);
  } catch (const std::exception& error) {
    painters_.clear();
    fmt::print(stderr, "understudy: stage: polygons are drawn by one process: painter of a strip: {}\n",
               error.what());
    give_up("a painter of a strip could not be had");
  }
}

void Painters::send(Painter& painter, const Records& records, bool wants_answer) {
  const CallsHead head{0, wants_answer ? StageReply::answer : StageReply::none, records.words().size(),
                       records.payload().size()};
  painter.chunks.clear();
  painter.chunks.add(records.words(), records.payload());
  const std::uint64_t count = painter.chunks.heads().size();
  const std::array<compositor::Bytes, 4> parts = {
      std::as_bytes(std::span(&head, 1)), std::as_bytes(std::span(&count, 1)),
      std::as_bytes(painter.chunks.heads()), std::as_bytes(painter.chunks.data())};
  painter.connection.send(MessageType::calls, 0, parts, limits::stage_patience);
}

void Painters::lose(const char* what) {
  painters_.clear();
  fmt::print(stderr, "understudy: stage: polygons are drawn by one process from here on: a painter {}\n", what);
  give_up("a painter of a strip was lost");
}

void Painters::hand_on(bool now) {
  const std::size_t words = records_.words().size() + records_.payload().size();
  if (words == 0 || (!now && words < many_words)) return;
  try {
    for (const auto& painter : painters_) send(*painter, records_, false);
  } catch (const std::exception& error) {
    lose(error.what());
  }
  records_.clear();
}

void Painters::ask(int index, const Records& records) {
  if (index >= count()) return;
  try {
    send(*painters_[std::size_t(index)], records, true);
  } catch (const std::exception& error) {
    lose(error.what());
  }
}

CallAnswer Painters::answer(int index) {
  if (index >= count()) return {};
  try {
    const Message message =
        painters_[std::size_t(index)]->connection.receive(Clock::now() + limits::stage_patience);
    auto answer = decode_answer(message.payload);
    if (message.type != MessageType::answered || !answer) throw MalformedMessage("spoke out of turn");
    return std::move(*answer);
  } catch (const std::exception& error) {
    lose(error.what());
    return {};
  }
}

void Painters::end_strips() {
  --in_strips_;
  let_go_if_unused();
}

void Painters::give_up(const char* why) {
  if (given_up_ != nullptr) return;
  given_up_ = why;
  put_text(process_counters().strips.given_up, why);
  let_go_if_unused();
}

/// Of what is still drawn in strips they have a part.
void Painters::let_go_if_unused() {
  if (in_strips_ > 0 || given_up_ == nullptr) return;
  painters_.clear();
  records_.clear();
}

}  // namespace understudy::spu
