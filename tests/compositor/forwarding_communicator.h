// SPDX-License-Identifier: Apache-2.0
// A Communicator that forwards all calls to another one: tests override single functions.
#pragma once

#include "compositor/exchange/communicator.h"

namespace understudy::compositor::testing {

class ForwardingCommunicator : public Communicator {
 public:
  explicit ForwardingCommunicator(Communicator& communicator) : communicator_(communicator) {}
  Rank rank() const override { return communicator_.rank(); }
  int size() const override { return communicator_.size(); }
  std::vector<int> machines() const override { return communicator_.machines(); }
  void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override {
    communicator_.transfer(outgoing, incoming);
  }
  std::span<std::byte> shared_segment(std::size_t bytes) override {
    return communicator_.shared_segment(bytes);
  }
  void broadcast(Rank root, std::span<std::byte> bytes) override { communicator_.broadcast(root, bytes); }
  void gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) override {
    communicator_.gather_to_all(mine, all);
  }
  void send_control(Rank to, std::span<const std::byte> control) override {
    communicator_.send_control(to, control);
  }
  std::optional<ControlMessage> take_control_message() override { return communicator_.take_control_message(); }
  ControlMessage wait_for_control_message() override { return communicator_.wait_for_control_message(); }
  [[noreturn]] void abandon(const std::string& why) override {
    communicator_.abandon(why);
    throw RankLost(why);  // never reached; gcc does not trust [[noreturn]] on virtual functions
  }

 private:
  Communicator& communicator_;
};

}  // namespace understudy::compositor::testing
