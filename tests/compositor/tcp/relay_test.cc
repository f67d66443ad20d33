// SPDX-License-Identifier: Apache-2.0
// Applications and nodes connected over TCP: images are those of a Unix socket, a connection that pauses for a
// while continues, and one that is lost ends both sides.
#include "compositor/transport/tcp/relay.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "compositor/relay/packing_choice.h"
#include "compositor/relay/render_relay.h"
#include "compositor/service/service_protocols.h"
#include "compositor/transport/tcp/listener.h"
#include "compositor/transport/tcp/tcp_socket.h"
#include "tests/compositor/node_group.h"
#include "tests/compositor/tcp/line.h"
#include "volume/blending_operator.h"
#include "volume/image.h"

namespace understudy::compositor::testing {
namespace {

class RelayTest : public NodeGroupTest {
 protected:
  void SetUp() override {
    listener_thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        std::vector<pollfd> fds;
        listener_.poll_fds(fds);
        ::poll(fds.data(), fds.size(), 1);
        listener_.step();
      }
    });
  }
  void TearDown() override {
    service_.reset();
    application_.clear();
    listener_thread_ = {};
    carriers_.clear();
    NodeGroupTest::TearDown();
  }

  /// Returns the service of an application that is connected over TCP.
  RenderService& connect_over(const TcpAddress& address, const ConnectionRequest& connection_request = {}) {
    const std::string path = folder_ / "relay";
    const FileDescriptor listener = listen_at(path);
    application_.emplace_back([this, address, connection_request, fd = ::dup(listener.get())] {
      const FileDescriptor listening(fd);
      if (!wait_until_ready(listening.get(), POLLIN, soon())) return;
      Connection here(
          FileDescriptor(::accept4(listening.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)),
          service_protocols);
      TcpConnection tcp(connect_tcp(address, secret_, connection_request, soon()), service_protocols,
                        limits::max_image_message_bytes, connection_patience_);
      std::string why = ApplicationRelay(here, tcp).run();
      const std::scoped_lock lock(why_mutex_);
      why_ = std::move(why);
    });
    service_ = remote_render_service(path, 20'000);
    ::unlink(path.c_str());
    return *service_;
  }

  milliseconds connection_patience_ = limits::connection_patience;
  /// Of the far end, if different.
  std::optional<milliseconds> far_patience_;
  const Credentials secret_{Secret(std::as_bytes(std::span("sixteen bytes or more")))};
  std::vector<std::jthread> carriers_;
  Listener listener_ = Listener(
      TcpAddress{"127.0.0.1", 0}, secret_, [](const ConnectionRequest&) { return AdmissionVerdict::accepted; },
      [this](AuthenticatedSocket client, const ConnectionRequest& connection_request) {
        carriers_.emplace_back(
            [this, peer = std::make_shared<AuthenticatedSocket>(std::move(client)), connection_request] {
              TcpConnection tcp(std::move(*peer), service_protocols, limits::max_message_bytes,
                                far_patience_.value_or(connection_patience_));
              Connection here(connect_to(path_, soon()), service_protocols);
              NodesRelay(here, tcp, connection_request).run();
            });
      },
      [](const std::string& line) { std::printf("%s\n", line.c_str()); });
  std::jthread listener_thread_;
  std::mutex why_mutex_;  // the end of one application may overlap with that of the next
  std::string why_;       ///< why the last one has ended; to be read once all have
  std::vector<std::jthread> application_;
  std::unique_ptr<RenderService> service_;
};

TEST_F(RelayTest, ImagesAreThoseOfAUnixSocketToTheBit) {
  start(3);
  const Texture texture = some_texture();
  const auto here = connect();
  RenderService& there = connect_over(listener_.address());
  EXPECT_EQ(there.nodes(), 3);
  Texture other = texture;
  other.description.id = 8;
  upload(*here, texture);
  upload(there, other);
  for (const volume::Operator op : {volume::Operator::over, volume::Operator::max, volume::Operator::min}) {
    auto request = some_request(texture, op);
    const volume::Image expected = whole_image(here->render(request), request);
    request.volume = 8;
    EXPECT_EQ(whole_image(there.render(request), request).rgba, expected.rgba);
    // A larger window: new image buffers at both ends.
    request = volume::testing::request_for(other, volume::testing::usual_camera(301, 203), 301, 203, 50);
    const volume::Image large = whole_image(there.render(request), request);
    request.volume = texture.description.id;
    EXPECT_EQ(whole_image(here->render(request), request).rgba, large.rgba);
  }
  // A refusal arrives as one, and the connection continues.
  auto unknown = some_request(texture);
  unknown.volume = 99;
  EXPECT_THROW(there.render(unknown), RequestRefused);
  there.forget_volume(8);
}

TEST_F(RelayTest, NarrowerImagesHaveTheErrorThatWasAskedFor) {
  start(2);
  const Texture texture = some_texture();
  const auto request = some_request(texture);
  const auto here = connect();
  upload(*here, texture);
  const volume::Image expected = whole_image(here->render(request), request);
  for (const auto& [connection_request, most, rms] :
       {std::tuple(ConnectionRequest{Destination::nodes, Layout::rgba16f}, 1.0 / 2048, 1.0 / 2048),
        std::tuple(ConnectionRequest{Destination::nodes, Layout::rgba8}, 1.0 / 510 + 1e-6, 1.0 / 510),
        std::tuple(ConnectionRequest{Destination::nodes, Layout::rgba32f, 85}, 0.3, 0.03)}) {
    RenderService& there = connect_over(listener_.address(), connection_request);
    upload(there, texture);
    double largest = 0;
    double sum = 0;
    const volume::Image got = whole_image(there.render(request), request);
    for (std::size_t i = 0; i < got.rgba.size(); ++i) {
      const double difference = std::abs(double(got.rgba[i]) - double(expected.rgba[i]));
      largest = std::max(largest, difference);
      sum += difference * difference;
    }
    const double measured = std::sqrt(sum / double(got.rgba.size()));
    std::printf("largest %.2e, rms %.2e\n", largest, measured);
    EXPECT_LE(largest, most);
    EXPECT_LE(measured, rms);
    EXPECT_GT(largest, 0) << "it was narrower";
    if (connection_request.jpeg_quality > 0) {
      EXPECT_EQ(whole_image(there.render(request), request).rgba, expected.rgba) << "the view rests";
    }
    service_.reset();
    application_.clear();
  }
}

TEST_F(RelayTest, ExactImagesAndBoundsLoseNothing) {
  start(2);
  const Texture texture = texture_for_bounds();
  const volume::RenderRequest bounds = request_for_bounds(texture);
  volume::RenderRequest any = bounds;
  any.bound_of.reset();
  const volume::RenderRequest exact = volume::exactly(any);
  const auto here = connect();
  upload(*here, texture);
  const volume::Image expected = image_of(*here, exact), expected_bounds = image_of(*here, bounds);
  for (const ConnectionRequest& connection_request :
       {ConnectionRequest{Destination::nodes, Layout::rgba16f},
        ConnectionRequest{Destination::nodes, Layout::rgba8},
        ConnectionRequest{Destination::nodes, Layout::rgba32f, 40},
        ConnectionRequest{Destination::nodes, Layout::rgba8, 40}}) {
    RenderService& there = connect_over(listener_.address(), connection_request);
    upload(there, texture);
    EXPECT_EQ(image_of(there, exact).rgba, expected.rgba);
    EXPECT_EQ(image_of(there, bounds).rgba, expected_bounds.rgba);
    EXPECT_FALSE(there.render(exact).lossy);
    EXPECT_EQ(there.render(any).lossy, connection_request.jpeg_quality > 0);
    EXPECT_FALSE(there.render(any).lossy) << "the view rests";
    service_.reset();
    application_.clear();
  }
}

TEST_F(RelayTest, SeveralViewsThatRestLoseNothing) {
  start(2);
  const Texture texture = some_texture();
  RenderService& there = connect_over(listener_.address(), {Destination::nodes, Layout::rgba32f, 40});
  upload(there, texture);
  std::array<volume::RenderRequest, 4> requests;
  for (std::size_t i = 0; i < requests.size(); ++i)
    requests[i] =
        volume::testing::request_for(texture, volume::testing::usual_camera(160, 120), 160, 120, 50 + int(i));
  for (const volume::RenderRequest& request : requests) EXPECT_TRUE(there.render(request).lossy);
  for (const volume::RenderRequest& request : requests) EXPECT_FALSE(there.render(request).lossy);
}

TEST(PackingChoice, TriesAgainAfterPackingSeemedNotToPay) {
  constexpr double line = 100e6;
  PackingChoice packing;
  EXPECT_FALSE(packing.pays(0)) << "the speed is not known yet";
  EXPECT_TRUE(packing.pays(line));
  packing.packed(1e-3, 10'000, 5'000);  // while the machine was busy
  for (int turn = 0; turn < 2; ++turn) {
    int unpacked = 0;
    while (unpacked < 1000 && !packing.pays(line)) ++unpacked;
    EXPECT_EQ(unpacked, 200);
  }
  for (int i = 0; i < 20; ++i) packing.packed(5e-6, 10'000, 5'000);
  EXPECT_TRUE(packing.pays(line)) << "packing is fast again";
  EXPECT_TRUE(packing.pays(line));
}

TEST_F(RelayTest, ALineThatIsCutForAWhileGoesOnWhereItWas) {
  start(2);
  Line line(listener_.address());
  const Texture texture = some_texture();
  const auto request = some_request(texture);
  RenderService& there = connect_over(line.address());
  upload(there, texture);
  const volume::Image before = whole_image(there.render(request), request);
  line.stand_still();
  const std::jthread again([&] {
    std::this_thread::sleep_for(std::chrono::seconds(3));
    line.go_on();
  });
  EXPECT_EQ(whole_image(there.render(request), request).rgba, before.rgba);
}

TEST_F(RelayTest, WhoRestsForLongerThanALineMayBeSilentIsStillThere) {
  start(1);
  connection_patience_ = milliseconds(2000);
  const Texture texture = some_texture();
  const auto request = some_request(texture);
  RenderService& there = connect_over(listener_.address());
  upload(there, texture);
  const volume::Image before = whole_image(there.render(request), request);
  std::this_thread::sleep_for(2 * connection_patience_);
  EXPECT_EQ(whole_image(there.render(request), request).rgba, before.rgba);
}

TEST_F(RelayTest, ALineThatIsSilentIsGivenUpAndSaidSo) {
  start(1);
  connection_patience_ = milliseconds(2000);
  far_patience_ = milliseconds(20000);  // so that the far end does not give up first
  Line line(listener_.address());
  const Texture texture = some_texture();
  RenderService& there = connect_over(line.address());
  upload(there, texture);
  line.stand_still();
  EXPECT_THROW(there.render(some_request(texture)), ServiceLost);
  line.go_on();
  application_.clear();
  EXPECT_NE(why_.find("has said nothing for 2 s"), std::string::npos) << why_;
}

TEST_F(RelayTest, ALineThatIsGoneIsALostService) {
  start(2);
  Line line(listener_.address());
  const Texture texture = some_texture();
  const auto request = some_request(texture);
  RenderService& there = connect_over(line.address());
  upload(there, texture);
  line.cut();
  EXPECT_THROW(there.render(request), ServiceLost);
  // The nodes serve others, and a new connection.
  upload(connect_over(listener_.address()), texture);
  EXPECT_NO_THROW(service_->render(request));
}

TEST_F(RelayTest, AClientThatWouldBeTheNodesIsSentAway) {
  // Before there is a node group.
  TcpConnection tcp(connect_tcp(listener_.address(), secret_, {}, soon()), service_protocols,
                    limits::max_message_bytes);
  const std::vector<std::byte> hello = encode(Hello{});
  const Bytes payload(hello);
  tcp.send(LauncherMessage::hello_nodes, 0, {&payload, 1});
  EXPECT_THROW(for (;;) tcp.receive(), ConnectionLost);
  start(1);
  const Texture texture = some_texture();
  EXPECT_NO_THROW(upload(connect_over(listener_.address()), texture));
}

TEST_F(RelayTest, AnApplicationThatLeavesEndsItsWayThrough) {
  start(1);
  const auto before = open_descriptors();
  for (int i = 0; i < 5; ++i) {
    const Texture texture = some_texture();
    upload(connect_over(listener_.address()), texture);
    service_.reset();
    application_.clear();
    EXPECT_EQ(why_, "");
  }
  listener_thread_ = {};
  carriers_.clear();
  EXPECT_TRUE(eventually([&] { return open_descriptors() <= before; })) << open_descriptors() << " " << before;
}

/// An application's end of a relay, and the far end of its connection over TCP.
class LongMessageTest : public ::testing::Test {
 protected:
  LongMessageTest() {
    // Cannot be compressed.
    std::generate(texels_.begin(), texels_.end(),
                  [random = std::mt19937(1)]() mutable { return std::byte(random()); });
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0);
    application_.emplace(FileDescriptor(ends[0]), service_protocols);
    near_ = std::jthread([this, fd = ends[1]] {
      Connection here(FileDescriptor(fd), service_protocols);
      TcpConnection tcp({connect_to(line_.address(), soon()), {}}, service_protocols, limits::max_message_bytes,
                        patience_);
      Relay(here, tcp).run();
    });
    EXPECT_TRUE(wait_until_ready(listening_.get(), POLLIN, soon()));
    far_.emplace(
        AuthenticatedSocket{
            FileDescriptor(::accept4(listening_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)), {}},
        service_protocols, limits::max_message_bytes, patience_);
    receiver_ = std::jthread([this] {
      try {
        message_ = far_->receive();
      } catch (const ConnectionLost& error) {
        ADD_FAILURE() << error.what();
      }
    });
    far_lives_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        far_->send_alive();
        std::this_thread::sleep_for(patience_ / 8);
      }
    });
  }
  ~LongMessageTest() override {
    far_lives_ = {};
    ::shutdown(application_->fd(), SHUT_RDWR);
  }

  void expect_all() {
    receiver_.join();
    EXPECT_EQ(message_.type, NodeMessage::add_texels);
    EXPECT_EQ(message_.payload, texels_);
  }

#ifdef __SANITIZE_THREAD__
  const milliseconds patience_{10'000};  // each byte takes ThreadSanitizer ten times as long
#else
  const milliseconds patience_{2000};
#endif
  const FileDescriptor listening_ = listen_at(TcpAddress{"127.0.0.1", 0});
  Line line_{own_address(listening_.get())};
  /// More than sockets buffer.
  std::vector<std::byte> texels_ = std::vector<std::byte>(std::size_t(64) << 20);
  std::optional<Connection> application_;
  std::optional<TcpConnection> far_;
  Message message_;
  std::jthread near_;
  std::jthread receiver_;
  std::jthread far_lives_;
};

/// An application that waits for its answer must wait for the GL server, not for the connection.
TEST_F(LongMessageTest, LeavesAnApplicationAsALineTakesIt) {
  // For longer than either end waits for the other.
  line_.set_bytes_per_second(double(texels_.size()) / (1.4e-3 * double(patience_.count())));
  const Bytes payload(texels_);
  application_->send(NodeMessage::add_texels, 7, {&payload, 1}, patience_);
  EXPECT_GT(line_.bytes_up(), texels_.size() / 2);
  expect_all();
}

TEST_F(LongMessageTest, GoesOnWhereAnApplicationWasStopped) {
  MessageHeader header;
  header.type = NodeMessage::add_texels;
  header.payload_bytes = texels_.size();
  const auto send = [&](Bytes bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(application_->fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent > 0) bytes = bytes.subspan(std::size_t(sent));
      if (sent < 0) wait_until_ready(application_->fd(), POLLOUT, soon());
    }
  };
  send(std::as_bytes(std::span(&header, 1)));
  send(Bytes(texels_).first(1'000'000));
  std::this_thread::sleep_for(2 * patience_);
  send(Bytes(texels_).subspan(1'000'000));
  expect_all();
}

}  // namespace
}  // namespace understudy::compositor::testing
