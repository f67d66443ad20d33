#include "spu/link/stage_link.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "compositor/service/limits.h"
#include "compositor/service/socket.h"
#include "spu/report/counters.h"

namespace understudy::spu {

using compositor::Clock;
using compositor::Connection;
using compositor::ConnectionLost;
using compositor::MalformedMessage;
using compositor::Message;
using compositor::MessageHeader;
using compositor::MessageType;
namespace limits = compositor::limits;

namespace {

std::uint64_t thread_number() {
  static constinit std::atomic<std::uint64_t> threads{0};
  thread_local const std::uint64_t number = threads.fetch_add(1, std::memory_order_relaxed);
  return number;
}

RemoteCounters& counters() {
  return process_counters().remote;
}

}  // namespace

StageLink::StageLink(const std::string& address, FrontEnd& front) : front_(front) {
  try {
    connection_.emplace(compositor::connect_to(address, Clock::now() + limits::hello_patience),
                        limits::max_stage_message_bytes);
    connection_->send(MessageType::hello_client, 0, compositor::Bytes{}, Clock::now() + limits::hello_patience);
    Message welcome = connection_->receive(Clock::now() + limits::stage_patience);
    if (welcome.type == MessageType::refused)
      throw std::runtime_error(compositor::decode_text(welcome.payload));
    if (welcome.type != MessageType::welcome) throw MalformedMessage("its first message is no welcome");
    versions_ = decode_versions(welcome.payload);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format(
        "nothing can be drawn: the stage at '{}': {}; start the viewer with: understudy run --remote "
        "-- viewer args…",
        address, error.what()));
  }
  counters().is = 1;
}

void StageLink::lose(const std::string& why) {
  lost_ = true;
  connection_.reset();
  fmt::print(stderr,
             "understudy: the stage, which draws for this program, {}; its windows show nothing new any more, "
             "end it and start again\n",
             why);
}

void StageLink::transmit(const Records& records, StageReply reply) {
  const CallsHead head{thread_number(), reply, records.words().size(), records.payload().size()};
  chunks_.clear();
  chunks_.add(records.words(), records.payload());
  const std::uint64_t count = chunks_.heads().size();
  const std::array<compositor::Bytes, 4> parts = {
      std::as_bytes(std::span(&head, 1)), std::as_bytes(std::span(&count, 1)), std::as_bytes(chunks_.heads()),
      std::as_bytes(chunks_.data())};
  connection_->send(MessageType::calls, 0, parts, Clock::now() + limits::stage_patience);
  counters().bytes_up += sizeof(MessageHeader);
  for (const compositor::Bytes& part : parts) counters().bytes_up += part.size();
  if (reply != StageReply::none) ++counters().round_trips;
}

Message StageLink::receive(MessageType expected) {
  Message message = connection_->receive(Clock::now() + limits::stage_patience);
  counters().bytes_down += sizeof(MessageHeader) + message.payload.size();
  if (message.type == MessageType::refused)
    throw std::runtime_error("gives up: " + compositor::decode_text(message.payload));
  if (message.type != expected) throw MalformedMessage("spoke out of turn");
  return message;
}

void StageLink::send(const Records& records) {
  const std::scoped_lock lock(mutex_);
  if (lost_ || records.empty()) return;
  try {
    transmit(records, StageReply::none);
  } catch (const std::runtime_error& error) {
    lose(error.what());
  }
}

std::optional<CallAnswer> StageLink::ask(const Records& records) {
  const std::scoped_lock lock(mutex_);
  if (lost_) return std::nullopt;
  try {
    transmit(records, StageReply::answer);
    auto answer = decode_answer(receive(MessageType::answered).payload);
    if (!answer) throw MalformedMessage("answered what is no answer");
    return answer;
  } catch (const std::runtime_error& error) {
    lose(error.what());
    return std::nullopt;
  }
}

void StageLink::show_frame(const Records& records, std::uint64_t drawable) {
  const std::scoped_lock lock(mutex_);
  if (lost_) return;
  try {
    transmit(records, StageReply::picture);
    const Message message = receive(MessageType::picture);
    const PictureChange change = decode_picture(message.payload);
    ++counters().frames;
    auto& [extent, pixels] = pictures_[drawable];
    if (extent != change.extent) {
      extent = change.extent;
      pixels.assign(std::size_t(extent.width) * std::size_t(extent.height) * 4, 0);
    }
    const std::size_t row = std::size_t(change.width) * 4;
    for (int y = 0; y < change.height; ++y) {
      const std::size_t to =
          (std::size_t(change.y + y) * std::size_t(extent.width) + std::size_t(change.x)) * 4;
      if (row != 0) std::memcpy(pixels.data() + to, change.pixels.data() + std::size_t(y) * row, row);
    }
    front_.show(extent, pixels);
  } catch (const std::runtime_error& error) {
    lose(error.what());
  }
}

const char* StageLink::keep_text(const std::string& text) {
  const std::scoped_lock lock(mutex_);
  return texts_.insert(text).first->c_str();
}

}  // namespace understudy::spu
