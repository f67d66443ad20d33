// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/clients.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <vector>

#include "compositor/logging/log.h"
#include "compositor/service/service_protocols.h"

namespace understudy::compositor {

namespace {

/// Whether an application's message is for all ranks.
bool is_request(const MessageType& type) {
  if (const auto message = type.as<NodeMessage>())
    return *message >= NodeMessage::begin_volume && *message <= NodeMessage::integrals;
  return type == LoadMessage::load_volume || type == LoadMessage::continue_load ||
         type == LoadMessage::histogram;
}

void refuse_one_too_many(FileDescriptor application) {
  const std::string reason = fmt::format("{} applications are served already", limits::max_clients);
  try {
    Connection(std::move(application), service_protocols)
        .send(LauncherMessage::refused, 0, encode_text(reason), Connection::now_or_never());
  } catch (const ConnectionLost&) {
    // Gone while it waited.
  }
}

}  // namespace

Clients::Clients(const std::string& control_path, int ranks, std::chrono::milliseconds stall_patience)
    : launcher_(connect_to(control_path, Clock::now() + limits::send_patience), service_protocols),
      ranks_(ranks),
      stall_patience_(stall_patience) {
  launcher_.send(LauncherMessage::hello_nodes, 0, encode(Hello{ranks}), Clock::now() + limits::send_patience);
  heartbeat_.emplace(launcher_);
}

Clients::Event Clients::next() {
  heartbeat_->end();
  end_turn();
  for (;;) {
    if (!departed_.empty()) {
      const Departed departed{departed_.front()};
      departed_.pop_front();
      return departed;
    }

    std::vector<pollfd> fds{{launcher_.fd(), POLLIN, 0}};
    std::vector<std::uint64_t> numbers;
    bool unfinished = false;
    // In turn, beginning behind the application that was heard last, without those that rest.
    const Deadline now = Clock::now();
    const auto add = [&](auto first, auto last) {
      for (; first != last; ++first) {
        if (turns_.rests_until(first->first) > now) continue;
        fds.push_back({first->second.fd(), POLLIN, 0});
        numbers.push_back(first->first);
        unfinished |= first->second.unfinished();
      }
    };
    const auto behind = clients_.upper_bound(last_heard_);
    add(behind, clients_.end());
    add(clients_.begin(), behind);

    ::poll(fds.data(), fds.size(), wait_at_most(unfinished, now));
    if (fds.front().revents != 0 && !hear_launcher()) return Ended{};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      Connection& connection = clients_.at(numbers[i]);
      if (fds[i + 1].revents != 0) {
        if (std::optional<Event> event = hear(numbers[i], connection)) {
          last_heard_ = numbers[i];
          turn_began_ = Clock::now();
          const auto* memory = std::get_if<MemoryGiven>(&*event);
          refused_ = memory != nullptr && memory->memory.bytes() == 0;
          // A step of a load may take any time, even after its application has gone.
          const auto* request = std::get_if<Request>(&*event);
          if (request == nullptr || (request->message.type != LoadMessage::load_volume &&
                                     request->message.type != LoadMessage::continue_load))
            heartbeat_->begin(connection.fd());
          return std::move(*event);
        }
      } else if (connection.stalled(stall_patience_)) {
        drop(numbers[i], "stopped in the middle of a message");
      }
    }
  }
}

void Clients::end_turn() {
  if (turn_began_ == Deadline()) return;
  turns_.served(last_heard_, turn_began_, Clock::now(), refused_);
  turn_began_ = {};
  if (!clients_.contains(last_heard_)) turns_.forget(last_heard_);
}

// How long poll() may wait, in milliseconds: until an application has rested or may have stalled; -1: for ever.
int Clients::wait_at_most(bool unfinished, Deadline now) const {
  // A stalled message is noticed after at most twice the patience.
  Deadline until = unfinished ? now + stall_patience_ : Deadline::max();
  for (const auto& [number, connection] : clients_)
    if (const Deadline rested = turns_.rests_until(number); rested > now) until = std::min(until, rested);
  if (until == Deadline::max()) return -1;
  return int(std::chrono::ceil<std::chrono::milliseconds>(until - now).count());
}

// Accepts the applications that the launcher passes on; false if the launcher has gone.
bool Clients::hear_launcher() {
  try {
    while (std::optional<Message> message = launcher_.receive_some()) {
      if (message->type != LauncherMessage::client || !message->attached) continue;
      if (clients_.size() >= limits::max_clients) {
        refuse_one_too_many(std::move(message->attached));
        continue;
      }
      const std::uint64_t number = ++last_number_;
      Connection& connection =
          clients_.try_emplace(number, std::move(message->attached), service_protocols).first->second;
      try {
        connection.send(LauncherMessage::accepted, 0, encode(Hello{ranks_}), Connection::now_or_never());
      } catch (const ConnectionLost&) {
        clients_.erase(number);  // gone while it waited
      }
    }
    return true;
  } catch (const ConnectionLost&) {
    return false;
  } catch (const MalformedMessage&) {
    return false;
  }
}

// Returns the event of an application's message, if that is complete.
std::optional<Clients::Event> Clients::hear(std::uint64_t number, Connection& connection) {
  try {
    std::optional<Message> message = connection.receive_some();
    if (!message) return std::nullopt;
    if (message->type == NodeMessage::image_buffer)
      return MemoryGiven{number, take_image_buffer(connection, std::move(*message))};
    if (is_request(message->type)) return Request{number, std::move(*message)};
    throw MalformedMessage("an application does not send this type of message");
  } catch (const ConnectionLost& lost) {
    // An application that ends between two messages has done nothing wrong.
    drop(number, connection.unfinished() ? lost.what() : "");
  } catch (const std::exception& error) {
    drop(number, error.what());
  }
  return std::nullopt;
}

ImageBuffer Clients::take_image_buffer(Connection& connection, Message message) {
  MessageType answer = NodeMessage::done;
  std::vector<std::byte> payload;
  ImageBuffer memory;
  try {
    memory = ImageBuffer::map(std::move(message.attached), decode_size(message.payload));
  } catch (const std::runtime_error& error) {
    answer = LauncherMessage::refused;
    payload = encode_text(error.what());
  }
  connection.send(answer, message.sequence, payload, Connection::now_or_never());
  return memory;
}

void Clients::reply(const Request& request, MessageType type, Bytes payload) {
  refused_ = type == LauncherMessage::refused;
  const auto client = clients_.find(request.client);
  if (client == clients_.end()) return;
  try {
    client->second.send(type, request.message.sequence, payload, Connection::now_or_never());
  } catch (const ConnectionLost& lost) {
    drop(request.client, lost.what());
  }
}

void Clients::drop(std::uint64_t number, const std::string& why) {
  if (!why.empty()) logging::log(logging::Level::warn, "dropped application {}: {}", number, why);
  heartbeat_->end();
  clients_.erase(number);
  // A request in progress counts, too: end_turn() forgets its client.
  if (turn_began_ == Deadline() || number != last_heard_) turns_.forget(number);
  departed_.push_back(number);
}

}  // namespace understudy::compositor
