// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/thread_communicator.h"

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace understudy::compositor {

namespace {

// One queue of messages from each rank to each other. Broadcast and gather consist of plain messages, which
// keep their order, so the two never mix.
class Group {
 public:
  explicit Group(int ranks)
      : ranks_(ranks),
        queues_(std::size_t(ranks) * std::size_t(ranks)),
        control_messages_(std::size_t(ranks)),
        segments_(std::size_t(ranks)) {}

  int ranks() const { return ranks_; }

  void send(Rank from, Rank to, std::span<const std::byte> bytes) { queue_up(from, to, QueuedMessage(bytes)); }
  void leave(Rank from, Rank to, std::span<const std::byte> bytes) {
    QueuedMessage message;
    message.left = bytes;
    queue_up(from, to, std::move(message));
  }

  /// `seen` is set if the message was left in place.
  std::size_t take(Rank from, Rank to, std::span<std::byte> bytes, bool may_be_less = false,
                   std::span<const std::byte>* seen = nullptr) {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return !broken_.empty() || !queue(from, to).empty(); });
    if (queue(from, to).empty()) throw RankLost(broken_);
    const QueuedMessage queued = std::move(queue(from, to).front());
    queue(from, to).pop_front();
    if (!queued.left.empty()) {
      if (seen == nullptr) throw std::logic_error("a rank left a message where nobody looks");
      *seen = queued.left;
      return queued.left.size();
    }
    const std::vector<std::byte>& message = queued.bytes;
    if (message.size() > bytes.size() || (message.size() < bytes.size() && !may_be_less))
      throw std::logic_error("a rank sent another length than was expected");
    if (!message.empty()) std::memcpy(bytes.data(), message.data(), message.size());
    return message.size();
  }

  std::span<std::byte> segment(Rank rank, std::size_t bytes) {
    return {segments_[std::size_t(rank)].emplace_back(std::make_unique_for_overwrite<std::byte[]>(bytes)).get(),
            bytes};
  }
  bool has_segment(Rank rank, std::span<const std::byte> bytes) const {
    return std::ranges::any_of(segments_[std::size_t(rank)],
                               [&](const auto& segment) { return segment.get() == bytes.data(); });
  }
  /// Frees the memory, so that the address sanitizer reports ranks that read it later.
  void clear_segments(Rank rank) { segments_[std::size_t(rank)].clear(); }

  void leave_control_message(Rank to, ControlMessage control) {
    const std::lock_guard lock(mutex_);
    control_messages_[std::size_t(to)].push_back(std::move(control));
    arrived_.notify_all();
  }

  std::optional<ControlMessage> take_control_message(Rank to) {
    const std::lock_guard lock(mutex_);
    return first_control_message(to);
  }

  ControlMessage wait_for_control_message(Rank to) {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return !broken_.empty() || !control_messages_[std::size_t(to)].empty(); });
    if (std::optional<ControlMessage> control = first_control_message(to)) return std::move(*control);
    throw RankLost(broken_);
  }

  void break_off(const std::string& why) {
    const std::lock_guard lock(mutex_);
    if (broken_.empty()) broken_ = why;
    arrived_.notify_all();
  }

 private:
  struct QueuedMessage {
    QueuedMessage() = default;
    explicit QueuedMessage(std::span<const std::byte> copied) : bytes(copied.begin(), copied.end()) {}
    std::vector<std::byte> bytes;
    std::span<const std::byte> left;  ///< not empty: the message was left here
  };

  void queue_up(Rank from, Rank to, QueuedMessage message) {
    const std::lock_guard lock(mutex_);
    queue(from, to).push_back(std::move(message));
    arrived_.notify_all();
  }

  std::deque<QueuedMessage>& queue(Rank from, Rank to) {
    return queues_[std::size_t(from) * std::size_t(ranks_) + std::size_t(to)];
  }

  std::optional<ControlMessage> first_control_message(Rank to) {
    std::deque<ControlMessage>& control_messages = control_messages_[std::size_t(to)];
    if (control_messages.empty()) return std::nullopt;
    ControlMessage control = std::move(control_messages.front());
    control_messages.pop_front();
    return control;
  }

  int ranks_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<std::deque<QueuedMessage>> queues_;
  std::vector<std::deque<ControlMessage>> control_messages_;         // by receiver
  std::vector<std::vector<std::unique_ptr<std::byte[]>>> segments_;  // by owner, which alone uses the list
  std::string broken_;
};

class ThreadCommunicator : public Communicator {
 public:
  ThreadCommunicator(Group& group, Rank rank, bool share_memory)
      : group_(group), rank_(rank), share_memory_(share_memory) {}

  Rank rank() const override { return rank_; }
  int size() const override { return group_.ranks(); }
  std::vector<int> machines() const override {
    return share_memory_ ? std::vector<int>(std::size_t(size())) : Communicator::machines();
  }

  void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override {
    for (const Outgoing& message : outgoing) {
      if (message.may_be_seen && group_.has_segment(rank_, message.bytes))
        group_.leave(rank_, message.to, message.bytes);
      else
        group_.send(rank_, message.to, message.bytes);
    }
    for (const Incoming& message : incoming) {
      const std::size_t received =
          group_.take(message.from, rank_, message.bytes, message.received != nullptr, message.seen);
      if (message.received != nullptr) *message.received = received;
    }
  }

  std::span<std::byte> shared_segment(std::size_t bytes) override {
    if (!share_memory_) return {};
    return group_.segment(rank_, bytes);
  }

  void broadcast(Rank root, std::span<std::byte> bytes) override {
    if (rank_ != root) {
      group_.take(root, rank_, bytes);
      return;
    }
    for (Rank other = 0; other < size(); ++other)
      if (other != root) group_.send(root, other, bytes);
  }

  void gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) override {
    for (Rank other = 0; other < size(); ++other) group_.send(rank_, other, mine);
    for (Rank other = 0; other < size(); ++other)
      group_.take(other, rank_, all.subspan(std::size_t(other) * mine.size(), mine.size()));
    group_.clear_segments(rank_);
  }

  void send_control(Rank to, std::span<const std::byte> control) override {
    group_.leave_control_message(to, {rank_, {control.begin(), control.end()}});
  }
  std::optional<ControlMessage> take_control_message() override { return group_.take_control_message(rank_); }
  ControlMessage wait_for_control_message() override { return group_.wait_for_control_message(rank_); }

  [[noreturn]] void abandon(const std::string& why) override {
    group_.break_off(why);
    throw RankLost(why);
  }

 private:
  Group& group_;
  Rank rank_;
  bool share_memory_;
};

}  // namespace

void run_ranks(int ranks, const std::function<void(Communicator&)>& body, bool share_memory) {
  Group group(ranks);
  std::mutex mutex;
  std::exception_ptr first;
  {
    std::vector<std::jthread> threads;
    threads.reserve(std::size_t(ranks));
    for (Rank rank = 0; rank < ranks; ++rank) {
      threads.emplace_back([&, rank] {
        ThreadCommunicator communicator(group, rank, share_memory);
        try {
          body(communicator);
        } catch (...) {
          {
            const std::lock_guard lock(mutex);
            if (!first) first = std::current_exception();
          }
          group.break_off("another rank ended with an error");
        }
      });
    }
  }
  if (first) std::rethrow_exception(first);
}

}  // namespace understudy::compositor
