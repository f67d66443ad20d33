// SPDX-License-Identifier: Apache-2.0
// The web server against clients that must be refused or disconnected. Uses real sockets.
#include "apps/understudy/view/web_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <deque>
#include <filesystem>
#include <mutex>
#include <thread>

#include "apps/understudy/view/view_message.h"
#include "apps/understudy/view/web_client.h"

namespace understudy::launcher {
namespace {

using namespace std::chrono_literals;
using boost::asio::ip::tcp;
using boost::system::system_error;
using ::testing::HasSubstr;

constexpr const char* secret = "0123456789abcdef";

/// Long enough for any busy machine; normally the condition holds immediately.
constexpr auto patience = 30s;

class WebServerTest : public ::testing::Test {
 protected:
  void start(const WebLimits& limits = {}) {
    server_ = std::make_unique<WebServer>(
        "127.0.0.1", 0, secret,
        WebServer::Handlers{[this](WebServer::Viewer viewer) {
                              ++joined_;
                              server_->send_text(viewer, R"({"kind": "hello"})");
                            },
                            [this](WebServer::Viewer, std::string_view text) {
                              const std::lock_guard lock(mutex_);
                              said_ += text;
                            },
                            [this](WebServer::Viewer) { ++images_; }, [this](WebServer::Viewer) { ++left_; }},
        limits);
  }
  template <class Condition>
  static bool comes_true(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!condition() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(2ms);
    return condition();
  }

  tcp::socket connected() {
    tcp::socket socket(io_);
    socket.connect(tcp::endpoint(boost::asio::ip::make_address("127.0.0.1"), std::uint16_t(server_->port())));
    return socket;
  }
  /// Reads until the server closes the connection.
  static std::string all_of(tcp::socket& socket) {
    std::string text;
    boost::system::error_code error;
    boost::asio::read(socket, boost::asio::dynamic_buffer(text), error);
    return text;
  }
  std::string answer_to(const std::string& request) {
    tcp::socket socket = connected();
    boost::asio::write(socket, boost::asio::buffer(request));
    return all_of(socket);
  }

  boost::asio::io_context io_;
  std::atomic<int> joined_ = 0, left_ = 0, images_ = 0;
  std::mutex mutex_;
  std::string said_;
  std::unique_ptr<WebServer> server_;
};

TEST(WebHosts, OwnOnesAreAddressesLocalhostAndTheNameThatWasGiven) {
  for (const char* host :
       {"127.0.0.1:80", "127.0.0.1", "localhost:4711", "[::1]:80", "192.168.1.5:80", "node7:80"})
    EXPECT_TRUE(is_own_host(host, "node7")) << host;
  for (const char* host :
       {"", ":80", "evil.example:80", "localhost.evil.example", "[evil]:80", "127.0.0.1.evil.example"})
    EXPECT_FALSE(is_own_host(host, "127.0.0.1")) << host;
  EXPECT_TRUE(is_own_origin("", "localhost:80"));
  EXPECT_TRUE(is_own_origin("http://localhost:80", "localhost:80"));
  EXPECT_FALSE(is_own_origin("http://localhost:81", "localhost:80"));
  EXPECT_FALSE(is_own_origin("null", "localhost:80"));
  EXPECT_FALSE(is_own_origin("http://evil.example", "localhost:80"));
}

TEST_F(WebServerTest, ServesThePageAndNothingElse) {
  start();
  const auto get = [&](const std::string& path, const std::string& host = "localhost") {
    return answer_to("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
  };
  const std::string page = get("/");
  EXPECT_THAT(page, HasSubstr("200 OK"));
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy: default-src 'none'"));
  EXPECT_THAT(page, HasSubstr("view.js"));
  EXPECT_THAT(page, ::testing::Not(HasSubstr(secret)));
  for (const char* path : {"/view.js", "/view.css", "/connection.js", "/editor.js", "/overlay.js"})
    EXPECT_THAT(get(path), HasSubstr("200 OK")) << path;
  for (const char* path : {"/index.html", "/../secret.cc", "//", "/view.js?x", "*"})
    EXPECT_THAT(get(path), HasSubstr("404 Not Found")) << path;
  EXPECT_THAT(get("/", "evil.example"), HasSubstr("421 Misdirected Request"));
  EXPECT_THAT(answer_to("POST / HTTP/1.1\r\nHost: localhost\r\n\r\n"), HasSubstr("405"));
  EXPECT_EQ(answer_to("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhello"), "");
  EXPECT_EQ(answer_to("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(20000, 'x') + "\r\n\r\n"), "");
  EXPECT_EQ(answer_to(std::string(3000, '\n') + "\x16\x03\x01"), "");
}

TEST_F(WebServerTest, OnlyWhoHasTheSecretIsHeard) {
  start();
  {
    WebClient client(server_->port());
    client.greet(secret);
    EXPECT_EQ(client.receive().json.at("kind"), "hello");
    client.send_text("words");
    EXPECT_TRUE(comes_true([&] {
      const std::lock_guard lock(mutex_);
      return said_ == "words";
    }));
  }
  EXPECT_TRUE(comes_true([&] { return left_ == 1; }));
  {
    WebClient client(server_->port());
    client.greet("0123456789abcdee");
    EXPECT_EQ(client.receive().json.at("kind"), "refused");
    EXPECT_THROW(client.receive(), system_error);
  }
  for (const std::string& proof : {std::string("{}"), std::string(R"({"proof": 5})"), std::string("words"),
                                   std::string(R"({"proof": ""})")}) {
    WebClient client(server_->port());
    client.receive();
    client.send_text(proof);
    EXPECT_EQ(client.receive().json.at("kind"), "refused") << proof;
  }
  {
    WebClient client(server_->port());
    client.receive();
    client.send_text(std::string(1000, 'x'));  // longer than any proof
    EXPECT_THROW(client.receive(), system_error);
  }
  {
    // A proof from one connection is not valid in another.
    WebClient first(server_->port()), second(server_->port());
    const std::string challenge = first.receive().json.at("challenge");
    EXPECT_NE(second.receive().json.at("challenge"), challenge);
    second.send({{"proof", proof_of(secret, challenge)}});
    EXPECT_EQ(second.receive().json.at("kind"), "refused");
  }
  EXPECT_THROW(WebClient(server_->port(), "http://evil.example"), system_error);
  EXPECT_EQ(joined_, 1);
}

TEST_F(WebServerTest, AViewersMessagesAreBounded) {
  start();
  WebClient client(server_->port());
  client.greet(secret);
  client.receive();
  client.send_text(std::string(max_view_message_bytes, ' '));
  EXPECT_TRUE(comes_true([&] {
    const std::lock_guard lock(mutex_);
    return said_.size() == max_view_message_bytes;
  }));
  // The connection may be closed before all of it is sent.
  const auto exceed = [&] {
    client.send_text(std::string(max_view_message_bytes + 1, ' '));
    client.receive();
  };
  EXPECT_THROW(exceed(), system_error);
  EXPECT_TRUE(comes_true([&] { return left_ == 1; }));
}

TEST_F(WebServerTest, SilentAndSlowClientsAreClosed) {
  WebLimits limits;
  limits.greeting = 300ms;
  start(limits);
  tcp::socket silent = connected();
  EXPECT_EQ(all_of(silent), "");
  // Sending a byte now and then does not prolong the limit.
  tcp::socket slow = connected();
  boost::system::error_code error;
  const std::string start_of_request = "GET / HTTP/1.1\r\nHost: localhost\r\nX: ";
  boost::asio::write(slow, boost::asio::buffer(start_of_request), error);
  ASSERT_FALSE(error);
  EXPECT_TRUE(comes_true([&] {
    boost::asio::write(slow, boost::asio::buffer("x", 1), error);
    return bool(error);
  }));
  WebClient speechless(server_->port());
  EXPECT_EQ(speechless.receive().json.at("kind"), "challenge");
  EXPECT_THROW(speechless.receive(), system_error);
  EXPECT_EQ(joined_, 0);
}

TEST_F(WebServerTest, AViewerThatDoesNotReadIsDropped) {
  WebLimits limits;
  limits.sending = 300ms;
  limits.waiting_messages = 8;
  start(limits);
  WebClient client(server_->port());
  client.greet(secret);
  ASSERT_TRUE(comes_true([&] { return joined_ == 1; }));
  // More than the socket buffers hold, so it cannot be sent.
  server_->send_image(1, std::vector<std::byte>(std::size_t(64) << 20U));
  EXPECT_TRUE(comes_true([&] { return left_ == 1; }));
  EXPECT_EQ(images_, 0);

  WebClient second(server_->port());
  second.greet(secret);
  ASSERT_TRUE(comes_true([&] { return joined_ == 2; }));
  for (int i = 0; i < 20; ++i) server_->send_image(2, std::vector<std::byte>(std::size_t(8) << 20U));
  EXPECT_TRUE(comes_true([&] { return left_ == 2; }));
}

TEST_F(WebServerTest, NoMoreViewersThanThereIsRoomFor) {
  WebLimits limits;
  limits.viewers = 2;
  start(limits);
  std::deque<WebClient> clients;
  for (int i = 0; i < 3; ++i) {
    clients.emplace_back(server_->port()).greet(secret);
    EXPECT_EQ(clients.back().receive().json.at("kind"), i < 2 ? "hello" : "refused");
  }
}

int own_descriptors() {
  return int(std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}));
}

/// Raises the descriptor limit to the maximum that the system allows.
void raise_descriptor_limit() {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

TEST_F(WebServerTest, AFloodOfUnauthenticatedClientsTakesNobodysPlaceAndLeavesNothing) {
  raise_descriptor_limit();
  start();
  WebClient viewer(server_->port());
  viewer.greet(secret);
  viewer.receive();
  connected();  // the client side of sockets needs descriptors, too
  const int before = own_descriptors();
  int most = 0;
  {
    std::deque<tcp::socket> pending_clients;
    for (int i = 0; i < 1000; ++i) {
      pending_clients.push_back(connected());
      if (i % 50 == 49) {
        std::this_thread::sleep_for(5ms);
        // Both ends belong to this process.
        most = std::max(most, own_descriptors() - before - int(pending_clients.size()));
      }
    }
    std::printf("1000 pending clients: at most %d descriptors of the server's\n", most);
    EXPECT_LE(most, int(WebLimits().connections) + 50) << "and those that wait to be let in";
    WebClient newcomer(server_->port());
    newcomer.greet(secret);
    EXPECT_EQ(newcomer.receive().json.at("kind"), "hello") << "there is room for whom there is a reason";
  }
  EXPECT_TRUE(comes_true([&] { return own_descriptors() <= before; }));
  viewer.send_text("still here");
  EXPECT_TRUE(comes_true([&] {
    const std::lock_guard lock(mutex_);
    return said_ == "still here";
  }));
}

}  // namespace
}  // namespace understudy::launcher
