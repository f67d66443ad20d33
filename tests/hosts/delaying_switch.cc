// SPDX-License-Identifier: Apache-2.0
// delaying_switch MICROSECONDS INTERFACE...: an Ethernet switch between these interfaces that forwards every
// frame only after that time, as a network of machines would; the kernel's own bridge cannot delay. Prints
// "ready" when it forwards frames, and runs until it is killed. Frames keep their virtio header, so neither
// checksums nor segmentation are computed here.
#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <deque>
#include <map>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Address = std::array<unsigned char, ETH_ALEN>;

constexpr std::size_t header_bytes = 10;  // of a virtio_net_hdr, whose declaration is not C++
constexpr std::size_t longest_frame = header_bytes + (1 << 16) + 64;
constexpr int receive_buffer_bytes = 16 << 20;

struct Frame {
  Clock::time_point due;
  std::size_t from = 0;
  std::vector<unsigned char> bytes;
};

void check(int result, const std::string& what) {
  if (result < 0) throw std::system_error(errno, std::generic_category(), what);
}

int port_at(const std::string& interface) {
  // With a protocol, the socket would receive frames of all interfaces until it is bound to its own.
  const int port = socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  check(port, "a packet socket");
  const int on = 1;
  check(setsockopt(port, SOL_PACKET, PACKET_VNET_HDR, &on, sizeof on), "PACKET_VNET_HDR");
  check(setsockopt(port, SOL_PACKET, PACKET_IGNORE_OUTGOING, &on, sizeof on), "PACKET_IGNORE_OUTGOING");
  check(setsockopt(port, SOL_SOCKET, SO_RCVBUFFORCE, &receive_buffer_bytes, sizeof receive_buffer_bytes),
        "SO_RCVBUFFORCE");
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = int(if_nametoindex(interface.c_str()));
  check(bind(port, reinterpret_cast<const sockaddr*>(&address), sizeof address), interface);
  packet_mreq all{};
  all.mr_ifindex = address.sll_ifindex;
  all.mr_type = PACKET_MR_PROMISC;
  check(setsockopt(port, SOL_PACKET, PACKET_ADD_MEMBERSHIP, &all, sizeof all), interface);
  return port;
}

Address address_at(const Frame& frame, std::size_t offset) {
  Address address;
  std::copy_n(frame.bytes.begin() + std::ptrdiff_t(header_bytes + offset), ETH_ALEN, address.begin());
  return address;
}

class Switch {
 public:
  Switch(std::chrono::microseconds delay, std::vector<int> ports) : delay_(delay), ports_(std::move(ports)) {}

  [[noreturn]] void run() {
    std::vector<pollfd> waiting;
    for (const int port : ports_) waiting.push_back({port, POLLIN, 0});
    for (;;) {
      timespec left{1, 0};
      if (!held_.empty()) {
        const auto until = std::max(held_.front().due - Clock::now(), Clock::duration::zero());
        left = {0, std::chrono::duration_cast<std::chrono::nanoseconds>(until).count()};
      }
      ppoll(waiting.data(), waiting.size(), &left, nullptr);
      for (std::size_t port = 0; port < ports_.size(); ++port)
        if (waiting[port].revents != 0) receive(port);
      for (; !held_.empty() && held_.front().due <= Clock::now(); held_.pop_front()) hand_on(held_.front());
    }
  }

 private:
  void receive(std::size_t port) {
    // An interface that is down returns an error once, and works again when it is up.
    for (;;) {
      const ssize_t bytes = recv(ports_[port], room_.data(), room_.size(), 0);
      if (bytes < 0) return;
      if (std::size_t(bytes) < header_bytes + ETH_HLEN) continue;
      held_.push_back({Clock::now() + delay_, port, {room_.begin(), room_.begin() + bytes}});
      port_of_[address_at(held_.back(), ETH_ALEN)] = port;
    }
  }

  void hand_on(const Frame& frame) {
    const auto known = port_of_.find(address_at(frame, 0));
    for (std::size_t port = 0; port < ports_.size(); ++port) {
      if (port == frame.from || (known != port_of_.end() && known->second != port)) continue;
      // A frame that cannot be sent is lost, as on any network.
      [[maybe_unused]] const ssize_t sent = send(ports_[port], frame.bytes.data(), frame.bytes.size(), 0);
    }
  }

  std::chrono::microseconds delay_;
  std::vector<int> ports_;
  std::vector<unsigned char> room_ = std::vector<unsigned char>(longest_frame);
  std::deque<Frame> held_;  // in the order in which they are due
  std::map<Address, std::size_t> port_of_;
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) throw std::invalid_argument("usage: delaying_switch MICROSECONDS INTERFACE…");
  std::vector<int> ports;
  for (int argument = 2; argument < argc; ++argument) ports.push_back(port_at(argv[argument]));
  std::puts("ready");
  std::fflush(stdout);
  Switch(std::chrono::microseconds(std::stol(argv[1])), std::move(ports)).run();
} catch (const std::exception& error) {
  std::fprintf(stderr, "delaying_switch: %s\n", error.what());
  return 1;
}
