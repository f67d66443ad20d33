// SPDX-License-Identifier: Apache-2.0
// Serves the page and talks with the viewers that it opens, on a thread of its own. Anybody may connect: who
// has not shown the secret gets the page and nothing else, nobody holds a place for long without it, and every
// length is compared with a limit before it is believed.
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
  /// At once; a newcomer takes the place of the one that has been there longest without the secret.
  std::size_t connections = 64;
  std::size_t viewers = 16;                    ///< that have shown the secret
  std::chrono::milliseconds greeting{10'000};  ///< from accept to a whole request, and then to the proof
  std::chrono::milliseconds silence{60'000};   ///< of a viewer, whose browser answers pings by itself
  std::chrono::milliseconds sending{30'000};   ///< until a message has left
  std::size_t header_bytes = std::size_t(8) << 10U;
  std::size_t waiting_messages = 64;  ///< for one viewer; more end the conversation
};

class WebServer {
 public:
  using Viewer = std::uint64_t;  ///< never used twice

  /// Called on the server's thread, about viewers that have shown the secret; must not throw.
  struct Handlers {
    std::function<void(Viewer)> joined;
    std::function<void(Viewer, std::string_view text)> said;
    std::function<void(Viewer)> image_sent;
    std::function<void(Viewer)> left;
  };

  /// Listens on `host`, an address or a name, and `port`, 0 for any. Throws std::runtime_error.
  WebServer(const std::string& host, int port, std::string secret, Handlers handlers,
            const WebLimits& limits = {});
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  ~WebServer();

  int port() const;
  /// Who has this link has the secret. The part behind '#' stays in the browser.
  std::string link() const;

  // From any thread. To a viewer that has left, nothing is sent.
  void send_text(Viewer viewer, std::string text);
  void send_image(Viewer viewer, std::vector<std::byte> message);
  void send_text_to_all(std::string text);

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
};

/// Whether a request with this `Host` was meant for this server: pages elsewhere whose name was made to lead
/// here say their own. `bound` is the host that the server was told to listen on.
bool is_own_host(std::string_view host, std::string_view bound);
/// Whether a page with this `Origin` (empty: no page) came from the server that `host` names.
bool is_own_origin(std::string_view origin, std::string_view host);

}  // namespace understudy::launcher
