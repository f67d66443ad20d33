// SPDX-License-Identifier: Apache-2.0
// Serves the page and communicates with its viewers, on a separate thread. Anybody may connect, but an
// unauthenticated client gets only the page, and holds a connection for a limited time. Every length is checked
// against a limit before it is used.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace understudy::launcher {

struct WebLimits {
  /// Maximum number of connections; above it, a new connection replaces the oldest unauthenticated one.
  std::size_t connections = 64;
  std::size_t viewers = 16;                    ///< maximum number of authenticated viewers
  std::chrono::milliseconds greeting{10'000};  ///< limit for a complete request, and then again for the proof
  std::chrono::milliseconds silence{60'000};   ///< limit of inactivity; browsers answer pings by themselves
  std::chrono::milliseconds sending{30'000};   ///< time limit to send a message
  std::size_t header_bytes = std::size_t(8) << 10U;
  std::size_t waiting_messages = 64;  ///< maximum queue of one viewer; more close its connection
};

class WebServer {
 public:
  using Viewer = std::uint64_t;  ///< never used twice

  /// Called on the server's thread, for authenticated viewers only; must not throw.
  struct Handlers {
    std::function<void(Viewer)> joined;
    std::function<void(Viewer, std::string_view text)> said;
    std::function<void(Viewer)> image_sent;
    std::function<void(Viewer)> left;
  };

  /// Listens on `host`, an address or a name, and `port` (0: any free one). Throws std::runtime_error.
  WebServer(const std::string& host, int port, std::string secret, Handlers handlers,
            const WebLimits& limits = {});
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  ~WebServer();

  int port() const;
  /// The link contains the secret. Browsers do not send the part after '#'.
  std::string link() const;

  // May be called from any thread. Messages to viewers that have disconnected are discarded.
  void send_text(Viewer viewer, std::string text);
  void send_image(Viewer viewer, std::vector<std::byte> message);
  void send_text_to_all(std::string text);

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
};

/// Returns whether a request with this `Host` is meant for this server: pages of other sites whose name was
/// redirected here (DNS rebinding) send their own name. `bound` is the host of --bind.
bool is_own_host(std::string_view host, std::string_view bound);
/// Returns whether a page with this `Origin` (empty: no page) was loaded from the server that `host` names.
bool is_own_origin(std::string_view origin, std::string_view host);

}  // namespace understudy::launcher
