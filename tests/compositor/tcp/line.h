// SPDX-License-Identifier: Apache-2.0
// A connection between clients and a server that a test can pause or cut; forwards all clients that connect.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/tcp/address.h"

namespace understudy::compositor::testing {

class Line {
 public:
  /// Forwards to the server at `to`. Throws std::runtime_error.
  explicit Line(const TcpAddress& to);
  ~Line();

  /// The address for clients.
  const TcpAddress& address() const { return address_; }
  /// Bytes sent from the server to clients.
  std::uint64_t bytes_down() const { return bytes_down_; }
  /// Bytes sent from clients to the server.
  std::uint64_t bytes_up() const { return bytes_up_; }

  /// From now on; unlimited at first.
  void set_bytes_per_second(double rate) { bytes_per_second_ = rate; }
  /// Forwards nothing, in either direction, until go_on().
  void stand_still();
  void go_on();
  /// Ends all connections, and forwards no later client.
  void cut();

 private:
  void accept_all();
  void carry(int from, int to, bool down);
  void wait_while_still();

  TcpAddress to_;
  FileDescriptor listening_;
  TcpAddress address_;
  std::atomic<std::uint64_t> bytes_down_ = 0;
  std::atomic<std::uint64_t> bytes_up_ = 0;
  std::atomic<double> bytes_per_second_ = 0;  ///< 0: unlimited
  std::mutex mutex_;
  std::condition_variable changed_;
  bool still_ = false;
  std::vector<FileDescriptor> connections_;
  std::vector<std::jthread> carriers_;
  std::jthread accepting_;
};

}  // namespace understudy::compositor::testing
