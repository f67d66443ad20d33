// A Link with another one behind it: tests change single functions.
#pragma once

#include "compositor/exchange/link.h"

namespace understudy::compositor::testing {

class ForwardingLink : public Link {
 public:
  explicit ForwardingLink(Link& link) : link_(link) {}
  Rank rank() const override { return link_.rank(); }
  int size() const override { return link_.size(); }
  void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override {
    link_.transfer(outgoing, incoming);
  }
  std::span<std::byte> shared_room(std::size_t bytes) override { return link_.shared_room(bytes); }
  void broadcast(Rank root, std::span<std::byte> bytes) override { link_.broadcast(root, bytes); }
  void gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) override {
    link_.gather_to_all(mine, all);
  }
  void post(Rank to, std::span<const std::byte> note) override { link_.post(to, note); }
  std::optional<Note> take_note() override { return link_.take_note(); }
  Note wait_for_note() override { return link_.wait_for_note(); }
  [[noreturn]] void abandon(const std::string& why) override {
    link_.abandon(why);
    throw LinkLost(why);  // never reached; gcc does not believe a virtual function that it will not return
  }

 private:
  Link& link_;
};

}  // namespace understudy::compositor::testing
