// Where clients of other machines come in: a listening socket, whoever has come and not yet proved that it has
// the secret, and nothing else. Strangers cost a descriptor each, have limits::hello_patience, and when there
// are more than limits::max_strangers the one that has got least far, of these the oldest, makes room.
#pragma once

#include <poll.h>

#include <functional>
#include <string>
#include <vector>

#include "compositor/service/file_descriptor.h"
#include "compositor/service/socket.h"
#include "compositor/tcp/address.h"
#include "compositor/tcp/handshake.h"

namespace understudy::compositor {

struct GateLimits {
  std::chrono::milliseconds patience;  ///< from accept to a complete proof
  std::size_t strangers;
};

class Gate {
 public:
  using Say = std::function<void(const std::string&)>;
  /// Whether a client with these wishes may come in.
  using Judge = std::function<LinkVerdict(const LinkWishes&)>;
  /// A client that was told that it may.
  using Welcome = std::function<void(FileDescriptor socket, const LinkWishes& wishes)>;

  /// `secret` must outlive the gate. `say` gets a line about who was not let in, at most one a second. Throws
  /// std::runtime_error where nobody can listen.
  Gate(const TcpAddress& address, const Secret& secret, Judge judge, Welcome welcome, Say say);
  Gate(const TcpAddress& address, const Secret& secret, Judge judge, Welcome welcome, Say say,
       const GateLimits& limits);

  /// With the port that was given if any would do.
  const TcpAddress& address() const { return address_; }
  std::size_t strangers() const { return strangers_.size(); }

  /// Adds the descriptors to wait for.
  void poll_fds(std::vector<pollfd>& fds) const;
  /// When a stranger's time is up; the distant future without any.
  Deadline next_deadline() const;
  /// Handles what has happened, without waiting.
  void step();
  /// In a child process after fork(): closes all that it has inherited, without a word to anybody.
  void forget();

 private:
  struct Stranger {
    FileDescriptor socket;
    Deadline until;
    ServerHandshake handshake;
    std::vector<std::byte> heard;  ///< of the message that is coming
    bool let_in = false;           ///< it has heard so
  };

  void accept_all();
  void make_room();
  /// False when the stranger is done with, one way or the other.
  bool hear(Stranger& stranger);
  void drop(const Stranger& stranger, const std::string& why);

  const Secret& secret_;
  Judge judge_;
  Welcome welcome_;
  Say say_;
  GateLimits limits_;
  FileDescriptor listener_;
  TcpAddress address_;
  std::vector<Stranger> strangers_;  ///< the oldest first
  Deadline accept_again_{};
  Deadline say_again_{};
  std::size_t unsaid_ = 0;  ///< were dropped since the last line
};

}  // namespace understudy::compositor
