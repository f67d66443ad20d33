// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/web_server.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "apps/understudy/view/page_files.h"
#include "apps/understudy/view/secret.h"
#include "apps/understudy/view/view_message.h"

namespace understudy::launcher {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using Json = nlohmann::json;

constexpr std::size_t challenge_bytes = 16;
constexpr std::size_t max_proof_message_bytes = 256;
constexpr std::string_view socket_path = "/socket";

std::string_view text_of(boost::string_view view) {
  return {view.data(), view.size()};
}

/// Returns the host of "host:port" or "[::1]:port".
std::string_view without_port(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == std::string_view::npos ? std::string_view() : host.substr(1, end - 1);
  }
  return host.substr(0, host.rfind(':'));
}

std::string refusal(std::string_view reason) {
  return Json{{"kind", "refused"}, {"reason", reason}}.dump();
}

/// Sets close-on-exec: otherwise nodes that are started later would inherit Asio's sockets.
void keep_to_this_program(int socket) {
  ::fcntl(socket, F_SETFD, FD_CLOEXEC);
}

}  // namespace

bool is_own_host(std::string_view host, std::string_view bound) {
  const std::string name(without_port(host));
  error_code no_address;
  asio::ip::make_address(name, no_address);
  // IP addresses are safe: unlike names, they cannot be redirected to this machine by DNS.
  return !no_address || name == "localhost" || (!name.empty() && name == bound);
}

bool is_own_origin(std::string_view origin, std::string_view host) {
  if (origin.empty()) return true;
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.starts_with(scheme) && origin.substr(scheme.size()) == host) return true;
  return false;
}

class WebServer::Listener {
 public:
  Listener(const std::string& host, int port, std::string secret, Handlers handlers, const WebLimits& limits);
  ~Listener();
  void start();

  int port() const { return port_; }
  std::string link() const;
  void post(std::function<void()> work) { asio::post(io_, std::move(work)); }

  class Connection;
  struct Outgoing {
    bool image = false;
    std::vector<std::byte> bytes;
  };
  void send(Viewer viewer, Outgoing message);
  void send_to_all(const Outgoing& message);

 private:
  friend class Connection;

  void accept();
  void accepted(tcp::socket socket);
  void gone(Viewer number);
  std::size_t viewers() const;

  const std::string host_;
  const std::string secret_;
  const Handlers handlers_;
  const WebLimits limits_;
  asio::io_context io_{1};
  tcp::acceptor acceptor_{io_};
  asio::steady_timer pause_{io_};  // pause before accepting again, for example if there is no free descriptor
  int port_ = 0;
  Viewer next_ = 1;
  std::map<Viewer, std::shared_ptr<Connection>> connections_;  // ordered by age, oldest first
  std::jthread thread_;
};

// A browser's connection: a request for a file, or a WebSocket.
class WebServer::Listener::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Listener& listener, Viewer number, tcp::socket socket)
      : listener_(listener),
        number_(number),
        stream_(std::in_place, std::move(socket)),
        greeting_(listener.io_),
        sending_(listener.io_) {}

  bool is_viewer() const { return is_viewer_; }

  void start() {
    parser_.header_limit(std::uint32_t(listener_.limits_.header_bytes));
    parser_.body_limit(0);
    // One time limit for the whole request, however slowly it arrives.
    stream_->expires_after(listener_.limits_.greeting);
    http::async_read(*stream_, buffer_, parser_,
                     [self = shared_from_this()](error_code error, std::size_t) { self->requested(error); });
  }

  void drop() {
    if (dropped_) return;
    dropped_ = true;
    greeting_.cancel();
    sending_.cancel();
    error_code ignored;
    tcp::socket& socket = conversation_ ? beast::get_lowest_layer(*conversation_).socket() : stream_->socket();
    socket.shutdown(tcp::socket::shutdown_both, ignored);
    socket.close(ignored);
    // Deferred, because a caller may be iterating over the map that contains this connection.
    listener_.post([self = shared_from_this()] { self->listener_.gone(self->number_); });
  }

  void send(Outgoing message) {
    if (dropped_ || ending_ || !conversation_) return;
    if (outbox_.size() >= listener_.limits_.waiting_messages) return drop();
    outbox_.push_back(std::move(message));
    if (outbox_.size() == 1) write();
  }

 private:
  void requested(error_code error) {
    if (error) return drop();
    const auto& request = parser_.get();
    const std::string_view host = text_of(request[http::field::host]);
    if (!is_own_host(host, listener_.host_))
      return answer(
          http::status::misdirected_request, "text/plain",
          "This server answers only requests to localhost, to IP addresses and to the host of --bind.\n");
    if (websocket::is_upgrade(request)) {
      if (text_of(request.target()) != socket_path)
        return answer(http::status::not_found, "text/plain", "There is no WebSocket at this path.\n");
      if (!is_own_origin(text_of(request[http::field::origin]), host))
        return answer(http::status::forbidden, "text/plain",
                      "Connections from pages of other servers are rejected.\n");
      return converse();
    }
    if (request.method() != http::verb::get)
      return answer(http::status::method_not_allowed, "text/plain", "Only GET requests are supported.\n");
    for (const PageFile& file : page_files())
      if (text_of(request.target()) == file.path) return answer(http::status::ok, file.type, file.text);
    answer(http::status::not_found, "text/plain", "There is no such page.\n");
  }

  void answer(http::status status, std::string_view type, std::string_view text) {
    auto response = std::make_shared<http::response<http::string_body>>(status, 11);
    response->set(http::field::content_type, boost::string_view(type.data(), type.size()));
    response->set(http::field::cache_control, "no-store");
    response->set(http::field::x_frame_options, "DENY");
    response->set("X-Content-Type-Options", "nosniff");
    response->set("Referrer-Policy", "no-referrer");
    response->set("Content-Security-Policy",
                  "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
                  "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'");
    response->keep_alive(false);
    response->body() = text;
    response->prepare_payload();
    stream_->expires_after(listener_.limits_.greeting);
    http::async_write(*stream_, *response,
                      [self = shared_from_this(), response](error_code, std::size_t) { self->drop(); });
  }

  void converse() {
    buffer_.consume(buffer_.size());  // the client must not send anything before the response
    stream_->expires_never();
    conversation_.emplace(std::move(*stream_));
    stream_.reset();
    websocket::stream_base::timeout times{listener_.limits_.greeting, listener_.limits_.silence, true};
    conversation_->set_option(times);
    conversation_->read_message_max(max_proof_message_bytes);
    greeting_.expires_after(listener_.limits_.greeting);
    greeting_.async_wait([self = shared_from_this()](error_code error) {
      if (!error && !self->is_viewer_) self->drop();
    });
    conversation_->async_accept(parser_.get(), [self = shared_from_this()](error_code error) {
      if (error) return self->drop();
      self->challenge_ = random_digits(challenge_bytes);
      self->send(text(Json{{"kind", "challenge"}, {"challenge", self->challenge_}}.dump()));
      self->read();
    });
  }

  static Outgoing text(std::string_view words) {
    const auto bytes = std::as_bytes(std::span(words));
    return {false, {bytes.begin(), bytes.end()}};
  }

  void read() {
    conversation_->async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error || self->dropped_) return self->drop();
      self->heard();
    });
  }

  void heard() {
    const auto data = buffer_.cdata();
    const std::string words(static_cast<const char*>(data.data()), data.size());
    buffer_.consume(buffer_.size());
    if (!conversation_->got_text()) return refuse("messages of viewers must be text");
    if (is_viewer_) {
      listener_.handlers_.said(number_, words);
      return read();
    }
    const Json answer = Json::parse(words, nullptr, false);
    const auto proof = answer.is_object() ? answer.find("proof") : answer.end();
    if (proof == answer.end() || !proof->is_string() ||
        !equal(proof->get_ref<const std::string&>(), proof_of(listener_.secret_, challenge_)))
      return refuse("the secret is not this session's; use the link that is shown in the terminal");
    if (listener_.viewers() >= listener_.limits_.viewers)
      return refuse(fmt::format("{} viewers are connected already; close one", listener_.limits_.viewers));
    is_viewer_ = true;
    greeting_.cancel();
    conversation_->read_message_max(max_view_message_bytes);
    listener_.handlers_.joined(number_);
    read();
  }

  void refuse(std::string_view reason) {
    send(text(refusal(reason)));
    ending_ = true;
  }

  void write() {
    conversation_->text(!outbox_.front().image);
    conversation_->binary(outbox_.front().image);
    sending_.expires_after(listener_.limits_.sending);
    sending_.async_wait([self = shared_from_this()](error_code error) {
      if (!error && !self->outbox_.empty()) self->drop();
    });
    const std::vector<std::byte>& bytes = outbox_.front().bytes;
    conversation_->async_write(asio::buffer(bytes.data(), bytes.size()),
                               [self = shared_from_this()](error_code error, std::size_t) {
                                 if (error || self->dropped_) return self->drop();
                                 self->written();
                               });
  }

  void written() {
    const bool image = outbox_.front().image;
    outbox_.pop_front();
    sending_.cancel();
    if (!outbox_.empty())
      write();
    else if (ending_)
      drop();
    if (image && is_viewer_ && !dropped_) listener_.handlers_.image_sent(number_);
  }

  Listener& listener_;
  const Viewer number_;
  std::optional<beast::tcp_stream> stream_;
  std::optional<websocket::stream<beast::tcp_stream>> conversation_;  // replaces stream_
  beast::flat_buffer buffer_{2 * max_view_message_bytes};
  http::request_parser<http::string_body> parser_;
  asio::steady_timer greeting_;
  asio::steady_timer sending_;
  std::string challenge_;
  std::deque<Outgoing> outbox_;  // the first message is being written
  bool is_viewer_ = false;
  bool ending_ = false;  // drop the connection once the outbox is empty
  bool dropped_ = false;
};

WebServer::Listener::Listener(const std::string& host, int port, std::string secret, Handlers handlers,
                              const WebLimits& limits)
    : host_(host), secret_(std::move(secret)), handlers_(std::move(handlers)), limits_(limits) {
  const auto check = [&](const error_code& error, const char* what) {
    if (error)
      throw std::runtime_error(fmt::format("{}:{}: {} ({}); give another --web PORT or --bind HOST", host, port,
                                           what, error.message()));
  };
  error_code error;
  tcp::resolver resolver(io_);
  const auto found = resolver.resolve(host, std::to_string(port), tcp::resolver::passive, error);
  check(error, "not an address of this machine");
  const tcp::endpoint endpoint = found.begin()->endpoint();
  acceptor_.open(endpoint.protocol(), error);
  check(error, "cannot listen on this address");
  keep_to_this_program(acceptor_.native_handle());
  acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
  acceptor_.bind(endpoint, error);
  check(error, "cannot listen on this address");
  acceptor_.listen(tcp::acceptor::max_listen_connections, error);
  check(error, "cannot listen on this address");
  port_ = acceptor_.local_endpoint(error).port();
  check(error, "the port is unknown");
}

void WebServer::Listener::start() {
  accept();
  thread_ = std::jthread([this] { io_.run(); });
}

WebServer::Listener::~Listener() {
  io_.stop();
  thread_.join();
  connections_.clear();
}

std::string WebServer::Listener::link() const {
  const bool everywhere = host_ == "0.0.0.0" || host_ == "::";
  const bool bare_v6 = host_.find(':') != std::string::npos;
  const std::string host = everywhere ? "127.0.0.1" : bare_v6 ? "[" + host_ + "]" : host_;
  return fmt::format("http://{}:{}/#secret={}", host, port_, secret_);
}

void WebServer::Listener::accept() {
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    if (!error) {
      accepted(std::move(socket));
      return accept();
    }
    constexpr std::chrono::milliseconds a_moment{100};
    pause_.expires_after(a_moment);
    pause_.async_wait([this](error_code ended) {
      if (!ended) accept();
    });
  });
}

void WebServer::Listener::accepted(tcp::socket socket) {
  keep_to_this_program(socket.native_handle());
  if (connections_.size() >= limits_.connections) {
    const auto oldest =
        std::ranges::find_if(connections_, [](const auto& entry) { return !entry.second->is_viewer(); });
    if (oldest == connections_.end()) return;  // the new connection is closed
    oldest->second->drop();
    connections_.erase(oldest);
  }
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  const Viewer number = next_++;
  const auto connection = std::make_shared<Connection>(*this, number, std::move(socket));
  connections_[number] = connection;
  connection->start();
}

void WebServer::Listener::gone(Viewer number) {
  const auto found = connections_.find(number);
  if (found == connections_.end()) return;
  const bool was_viewer = found->second->is_viewer();
  connections_.erase(found);
  if (was_viewer) handlers_.left(number);
}

std::size_t WebServer::Listener::viewers() const {
  return std::size_t(
      std::ranges::count_if(connections_, [](const auto& entry) { return entry.second->is_viewer(); }));
}

void WebServer::Listener::send(Viewer viewer, Outgoing message) {
  const auto found = connections_.find(viewer);
  if (found != connections_.end()) found->second->send(std::move(message));
}

void WebServer::Listener::send_to_all(const Outgoing& message) {
  for (const auto& [number, connection] : connections_)
    if (connection->is_viewer()) connection->send(message);
}

WebServer::WebServer(const std::string& host, int port, std::string secret, Handlers handlers,
                     const WebLimits& limits)
    : listener_(std::make_unique<Listener>(host, port, std::move(secret), std::move(handlers), limits)) {
  listener_->start();  // handlers may call this server immediately
}
WebServer::~WebServer() = default;

int WebServer::port() const {
  return listener_->port();
}

std::string WebServer::link() const {
  return listener_->link();
}

void WebServer::send_text(Viewer viewer, std::string text) {
  listener_->post([listener = listener_.get(), viewer, text = std::move(text)] {
    const auto bytes = std::as_bytes(std::span(text));
    listener->send(viewer, {false, {bytes.begin(), bytes.end()}});
  });
}

void WebServer::send_image(Viewer viewer, std::vector<std::byte> message) {
  listener_->post([listener = listener_.get(), viewer, message = std::move(message)]() mutable {
    listener->send(viewer, {true, std::move(message)});
  });
}

void WebServer::send_text_to_all(std::string text) {
  listener_->post([listener = listener_.get(), text = std::move(text)] {
    const auto bytes = std::as_bytes(std::span(text));
    listener->send_to_all({false, {bytes.begin(), bytes.end()}});
  });
}

}  // namespace understudy::launcher
