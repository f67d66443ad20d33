// SPDX-License-Identifier: Apache-2.0
// The ranks of an MPI job. Only the source of this header uses MPI.
#pragma once

#include <list>
#include <memory>

#include "compositor/exchange/communicator.h"
#include "compositor/exchange/shared_segments.h"
#include "compositor/exchange/wake_up.h"

namespace understudy::compositor {

class MpiCommunicator : public Communicator {
 public:
  /// Starts MPI. One object per process, made on its main thread and used by one thread at a time. If all ranks
  /// are on one machine, they wake each other and read messages in place.
  MpiCommunicator(int& argc, char**& argv);
  ~MpiCommunicator() override;
  MpiCommunicator(const MpiCommunicator&) = delete;
  MpiCommunicator& operator=(const MpiCommunicator&) = delete;

  Rank rank() const override { return rank_; }
  int size() const override { return size_; }
  /// How many ranks of this job share this machine's processors.
  int ranks_on_this_machine() const { return local_size_; }

  std::vector<int> machines() const override { return machines_; }
  std::span<std::byte> shared_segment(std::size_t bytes) override;
  void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override;
  void broadcast(Rank root, std::span<std::byte> bytes) override;
  void gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) override;
  void send_control(Rank to, std::span<const std::byte> control) override;
  std::optional<ControlMessage> take_control_message() override;
  ControlMessage wait_for_control_message() override;
  [[noreturn]] void abandon(const std::string& why) override;

 private:
  struct SentControl;
  void meet_machine();
  void move(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming);
  void notify(Rank rank);
  void tell_others(Rank from, std::span<std::byte> bytes);
  void forget_sent();

  std::unique_ptr<WakeUp> wake_up_;           // if all ranks are on one machine
  std::unique_ptr<SharedSegments> segments_;  // likewise

  std::list<SentControl> sent_controls_;  // not yet known to be sent
  Rank rank_ = 0;
  int size_ = 1;
  int local_size_ = 1;
  std::vector<int> machines_;  ///< by rank: the lowest rank of its machine
};

}  // namespace understudy::compositor
