// SPDX-License-Identifier: Apache-2.0
#include "spu/remote/server_connection.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "compositor/service/blocked_signals.h"
#include "compositor/service/limits.h"
#include "compositor/transport/socket.h"
#include "spu/report/counters.h"
#include "spu/stream/event.h"

namespace understudy::spu {

using compositor::Clock;
using compositor::ConnectionLost;
using compositor::MalformedMessage;
using compositor::Message;
using compositor::MessageHeader;
namespace limits = compositor::limits;

namespace {

std::uint64_t thread_number() {
  static constinit std::atomic<std::uint64_t> threads{0};
  thread_local const std::uint64_t number = threads.fetch_add(1, std::memory_order_relaxed);
  return number;
}

Records front_shown(const FrontDrawable& drawable) {
  const std::uint64_t words[] = {std::uint64_t(drawable.extent.width), std::uint64_t(drawable.extent.height)};
  Records records;
  records.append_plain(event::front_shown, words);
  return records;
}

RemoteCounters& counters() {
  return process_counters().remote;
}

}  // namespace

ServerConnection::ServerConnection(const std::string& address, FrontEnd& front) : front_(front) {
  try {
    connection_.emplace(compositor::connect_to(address, Clock::now() + limits::hello_patience),
                        gl_server_protocols, limits::max_gl_server_message_bytes);
    connection_->send(compositor::LauncherMessage::hello_client, 0, compositor::Bytes{},
                      Clock::now() + limits::hello_patience);
    Message accepted = connection_->receive(Clock::now() + limits::server_patience);
    if (accepted.type == compositor::LauncherMessage::refused)
      throw std::runtime_error(compositor::decode_text(accepted.payload));
    if (accepted.type != compositor::LauncherMessage::accepted)
      throw MalformedMessage("its first message is no acceptance");
    versions_ = decode_versions(accepted.payload);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format(
        "nothing can be drawn: the GL server at '{}': {}; start the viewer with: understudy run --remote "
        "-- viewer args…",
        address, error.what()));
  }
  counters().is = 1;
  receiver_ = start(&ServerConnection::receive_all);
}

std::thread ServerConnection::start(void (ServerConnection::*work)()) {
  const compositor::BlockedSignals blocked;
  return std::thread([this, work] {
    try {
      (this->*work)();
    } catch (const std::exception& error) {
      lose(error.what());
    }
  });
}

ServerConnection::~ServerConnection() {
  end();
  receiver_.join();
  if (pending_shower_.joinable()) pending_shower_.join();
}

void ServerConnection::end() {
  ending_ = true;
  // Other threads may continue to send frames.
  const std::uint64_t last = frames_sent_;
  const compositor::Deadline until = Clock::now() + last_frames_patience;
  while (frames_shown_ < last && !lost_ && Clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ended_ = true;
  ::shutdown(connection_->fd(), SHUT_RDWR);
}

void ServerConnection::lose(std::string_view why) {
  std::call_once(losing_, [&] {
    // Logged before any thread continues without the GL server, since that may end the program.
    if (!ending_)
      fmt::print(
          stderr,
          "understudy: the GL server, which draws for this program, {}; its windows show nothing new any more, "
          "end it and start again\n",
          why);
    {
      const std::scoped_lock lock(replies_);
      lost_ = true;
      if (!ended_) {
        counters().lost = 1;
        counters().frames_lost += frames_.size();
      }
    }
    replied_.notify_all();
    ::shutdown(connection_->fd(), SHUT_RDWR);
  });
}

void ServerConnection::transmit(const Records& records, ServerReply reply, std::uint64_t thread) {
  const CallsHead head{thread, reply, records.words().size(), records.payload().size()};
  chunks_.clear();
  chunks_.add(records.words(), records.payload());
  const std::uint64_t count = chunks_.heads().size();
  const std::array<compositor::Bytes, 4> parts = {
      std::as_bytes(std::span(&head, 1)), std::as_bytes(std::span(&count, 1)), std::as_bytes(chunks_.heads()),
      std::as_bytes(chunks_.data())};
  try {
    connection_->send(GlServerMessage::calls, 0, parts, limits::server_patience);
  } catch (const std::runtime_error& error) {
    lose(error.what());
  }
  counters().bytes_up += sizeof(MessageHeader);
  for (const compositor::Bytes& part : parts) counters().bytes_up += part.size();
}

/// Returns when `condition` holds or the GL server is lost. Requires the lock of the replies.
template <class Condition>
void ServerConnection::wait_until(std::unique_lock<std::mutex>& lock, Condition condition) {
  const auto holds = [&] { return lost_ || condition(); };
  if (replied_.wait_for(lock, limits::server_patience, holds)) return;
  lock.unlock();
  lose("does not answer");
  lock.lock();
}

void ServerConnection::receive_all() {
  try {
    for (;;) {
      if (auto message = connection_->receive_some()) {
        take(std::move(*message));
      } else if (!compositor::wait_until_ready(connection_->fd(), POLLIN,
                                               Clock::now() + limits::server_patience) &&
                 connection_->unfinished()) {
        throw ConnectionLost("does not go on");
      }
    }
  } catch (const std::exception& error) {
    lose(error.what());
  }
}

void ServerConnection::take(Message message) {
  counters().bytes_down += sizeof(MessageHeader) + message.payload.size();
  if (message.type == compositor::LauncherMessage::refused)
    throw std::runtime_error("gives up: " + compositor::decode_text(message.payload));
  if (message.type == GlServerMessage::image) return take_image(message);
  if (message.type == GlServerMessage::refined) return refine_image(message);
  auto answer = decode_answer(message.payload);
  if (message.type != GlServerMessage::answered || !answer) throw MalformedMessage("spoke out of turn");
  {
    const std::scoped_lock lock(replies_);
    if (answers_.size() == awaited_) throw MalformedMessage("answered what nobody asked");
    answers_.push_back(std::move(*answer));
  }
  replied_.notify_all();
}

void ServerConnection::take_image(const Message& message) {
  const ImageChange change = decode_image(message.payload);
  FrontDrawable drawable;
  {
    const std::scoped_lock lock(replies_);
    if (frames_.empty()) throw MalformedMessage("sent an image that nobody waits for");
    drawable = frames_.front();
  }
  // There is nothing to show of a window that no longer exists, or of a frame that could not be made.
  if (change.extent.width > 0 && change.extent.height > 0) {
    Shown& shown = images_[drawable.number];
    shown.drawable = drawable;
    if (shown.extent != change.extent) {
      shown.extent = change.extent;
      shown.pixels.assign(std::size_t(change.extent.width) * std::size_t(change.extent.height) * 4, 0);
    }
    put(shown, change);
  }
  ++counters().frames;
  {
    const std::scoped_lock lock(replies_);
    frames_.pop_front();
  }
  ++frames_shown_;
  replied_.notify_all();
}

void ServerConnection::refine_image(const Message& message) {
  const ImageChange change = decode_image(message.payload);
  const auto shown = images_.find(change.drawable);
  // A refined image is not requested, and may belong to an image that no longer exists.
  if (shown != images_.end() && shown->second.extent == change.extent) put(shown->second, change);
}

void ServerConnection::put(Shown& shown, const ImageChange& change) {
  const std::size_t row = std::size_t(change.width) * 4;
  for (int y = 0; y < change.height; ++y) {
    const std::size_t to =
        (std::size_t(change.y + y) * std::size_t(change.extent.width) + std::size_t(change.x)) * 4;
    if (row != 0) std::memcpy(shown.pixels.data() + to, change.pixels.data() + std::size_t(y) * row, row);
  }
  if (!ended_) front_.show(shown.drawable, shown.extent, shown.pixels);
}

void ServerConnection::send(const Records& records) {
  const std::scoped_lock sending(sending_);
  if (!lost_ && !records.empty()) transmit(records, ServerReply::none, thread_number());
}

std::optional<CallAnswer> ServerConnection::ask(const Records& records) {
  std::vector<CallAnswer> answers = ask_all({&records, 1});
  if (answers.empty()) return std::nullopt;
  return std::move(answers.front());
}

std::vector<CallAnswer> ServerConnection::ask_all(std::span<const Records> questions) {
  const std::scoped_lock sending(sending_);
  if (lost_) return {};
  {
    const std::scoped_lock lock(replies_);
    answers_.clear();
    awaited_ = questions.size();
  }
  for (const Records& question : questions) transmit(question, ServerReply::answer, thread_number());
  ++counters().round_trips;
  std::unique_lock lock(replies_);
  wait_until(lock, [&] { return answers_.size() == awaited_; });
  awaited_ = 0;
  if (answers_.size() < questions.size()) return {};
  return std::exchange(answers_, {});
}

void ServerConnection::show_frame(const Records& records, const FrontDrawable& drawable) {
  const std::scoped_lock sending(sending_);
  {
    const std::scoped_lock lock(replies_);
    if (lost_) {
      ++counters().frames_lost;
      return;
    }
    frames_.push_back(drawable);
    pending_.erase(drawable.number);
  }
  transmit(records, ServerReply::image, thread_number());
  ++counters().round_trips;
  ++frames_sent_;
  std::unique_lock lock(replies_);
  wait_until(lock, [&] { return frames_.size() < frames_in_flight; });
}

void ServerConnection::show_front_now(const FrontDrawable& drawable) {
  show_frame(front_shown(drawable), drawable);
}

bool ServerConnection::show_front(const FrontDrawable& drawable) {
  const std::scoped_lock sending(sending_);
  if (lost_) return true;
  {
    const std::scoped_lock lock(replies_);
    if (!frames_.empty()) {
      pending_[drawable.number] = {thread_number(), drawable};
      if (!pending_shower_.joinable()) pending_shower_ = start(&ServerConnection::show_pending);
      return false;
    }
    frames_.push_back(drawable);
    pending_.erase(drawable.number);
  }
  transmit(front_shown(drawable), ServerReply::image, thread_number());
  ++frames_sent_;
  return true;
}

bool ServerConnection::is_front_pending(const FrontDrawable& drawable) {
  const std::scoped_lock lock(replies_);
  return pending_.contains(drawable.number);
}

/// What an application has flushed becomes visible even if it makes no further calls. The GL server then has
/// what was sent so far: the drawing before the last flush, or little more.
void ServerConnection::show_pending() {
  const auto can_show = [&] { return !pending_.empty() && frames_.empty(); };
  for (;;) {
    {
      std::unique_lock lock(replies_);
      replied_.wait(lock, [&] { return lost_ || can_show(); });
      if (lost_) return;
    }
    // Another thread may hold this lock for as long as it waits for an answer.
    const std::scoped_lock sending(sending_);
    PendingFront pending;
    {
      const std::scoped_lock lock(replies_);
      if (lost_ || !can_show()) continue;
      pending = pending_.begin()->second;
      pending_.erase(pending_.begin());
      frames_.push_back(pending.drawable);
    }
    transmit(front_shown(pending.drawable), ServerReply::image, pending.thread);
    ++frames_sent_;
  }
}

void ServerConnection::wait_for_frames() {
  std::unique_lock lock(replies_);
  wait_until(lock, [&] { return frames_.empty(); });
}

const char* ServerConnection::keep_text(const std::string& text) {
  const std::scoped_lock sending(sending_);
  return texts_.insert(text).first->c_str();
}

}  // namespace understudy::spu
