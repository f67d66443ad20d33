// Carries messages between a Unix socket of this machine and a link over TCP, both ways at once, until one of
// the two ends. There is one at each end of a link; applications, node groups and stages know nothing of TCP.
//
// What is not bytes, as a descriptor, stays on its machine: who carries for nodes (render_porter.h) or for a
// stage says in the two functions below what becomes of it.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "compositor/service/connection.h"
#include "compositor/tcp/tcp_link.h"

namespace understudy::compositor {

class Porter {
 public:
  /// Both must outlive it.
  Porter(Connection& here, TcpLink& link) : here_(here), link_(link) {}
  virtual ~Porter() = default;
  Porter(const Porter&) = delete;
  Porter& operator=(const Porter&) = delete;

  /// Returns when both directions have ended: a moment after the first of them. Why that did, if not because
  /// somebody left in an orderly way; else empty.
  std::string run();

 protected:
  /// What came from here, and goes to the link, but for what may be long (texels, a stage's calls) and is
  /// handed on as it comes. On a thread of its own, as the next.
  virtual void carry_out(Message message);
  /// The other way.
  virtual void carry_home(Message message);
  /// When rest() is called if nothing comes from here until then.
  virtual Deadline rest_due() const;
  virtual void rest() {}

  void send_here(const Message& message, int attach = -1) { send_here(message, message.payload, attach); }
  void send_here(const Message& message, Bytes payload, int attach = -1);
  void send_link(const Message& message, std::span<const Bytes> parts) {
    link_.send(message.type, message.sequence, parts);
  }
  double line_bytes_per_second() const { return link_.bytes_per_second(); }

 private:
  void carry_next_out();
  void wait_for_here();
  void hand_on(const MessageHeader& header);

  Connection& here_;
  TcpLink& link_;
  std::vector<std::byte> block_;
};

}  // namespace understudy::compositor
