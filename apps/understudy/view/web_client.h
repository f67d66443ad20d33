// SPDX-License-Identifier: Apache-2.0
// A client without a display, for tests and benchmarks: communicates with `understudy
// view --web` as the page does.
#pragma once

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "apps/understudy/view/secret.h"

namespace understudy::launcher {

class WebClient {
 public:
  using Json = nlohmann::json;
  using tcp = boost::asio::ip::tcp;

  struct Message {
    Json json;          ///< for an image: its header
    std::string image;  ///< empty: the message has no image
  };

  explicit WebClient(int port, const std::string& origin = "") : socket_(io_) {
    namespace websocket = boost::beast::websocket;
    boost::beast::get_lowest_layer(socket_).connect(
        tcp::endpoint(boost::asio::ip::make_address("127.0.0.1"), std::uint16_t(port)));
    socket_.set_option(websocket::stream_base::decorator([origin](websocket::request_type& request) {
      if (!origin.empty()) request.set(boost::beast::http::field::origin, origin);
    }));
    socket_.read_message_max(std::size_t(64) << 20U);
    socket_.handshake("127.0.0.1:" + std::to_string(port), "/socket");
  }

  /// Proves knowledge of the secret.
  void greet(const std::string& secret) {
    const Message challenge = receive();
    send({{"proof", proof_of(secret, challenge.json.at("challenge").get<std::string>())}});
  }

  void send(const Json& json) { send_text(json.dump()); }
  void send_text(const std::string& text) {
    socket_.text(true);
    socket_.write(boost::asio::buffer(text));
  }

  /// Throws boost::system::system_error if the connection has ended.
  Message receive() {
    boost::beast::flat_buffer buffer;
    socket_.read(buffer);
    const std::string bytes(static_cast<const char*>(buffer.cdata().data()), buffer.size());
    if (socket_.got_text()) return {Json::parse(bytes), {}};
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length |= std::uint32_t(std::uint8_t(bytes.at(i))) << 8 * i;
    return {Json::parse(bytes.substr(4, length)), bytes.substr(4 + length)};
  }

  /// Returns the next message of this kind; discards others.
  Message wait_for(const std::string& kind) {
    while (true)
      if (Message message = receive(); message.json.at("kind") == kind) return message;
  }

  /// Requests an image and waits for it.
  Message image(Json request) {
    request["sequence"] = ++sequence_;
    send(request);
    while (true) {
      Message message = receive();
      if (message.json.at("kind") == "impossible")
        throw std::runtime_error(message.json.at("text").get<std::string>());
      if (message.json.at("kind") == "image" && message.json.at("sequence") == sequence_) return message;
    }
  }

  tcp::socket& socket() { return boost::beast::get_lowest_layer(socket_); }

 private:
  boost::asio::io_context io_;
  boost::beast::websocket::stream<tcp::socket> socket_;
  int sequence_ = 0;
};

}  // namespace understudy::launcher
