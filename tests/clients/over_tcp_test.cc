// SPDX-License-Identifier: Apache-2.0
// Viewers whose nodes, or whose OpenGL, are reached over TCP: images equal those of a single machine, and
// clients without the secret are refused with a message and leave nothing behind.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>

#include "compositor/transport/tcp/tcp_connection.h"
#include "compositor/transport/tcp/tcp_socket.h"
#include "tests/apps/viewer/virtual_display.h"
#include "tests/clients/command_test.h"
#include "tests/compositor/tcp/line.h"

namespace clients {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using understudy::compositor::Clock;
using understudy::compositor::testing::Line;

class OverTcp : public CommandTest {
 protected:
  void SetUp() override {
    if (const std::string lacking = missing({Need::engine, Need::mpi}); !lacking.empty())
      GTEST_SKIP() << lacking;
  }

  /// Runs `understudy serve` with two nodes at a separate port.
  void serve(const Words& options = {}) { serve_with(Words{"--secret-file", secret()} + options); }
  void serve_with(const Words& options) {
    fs::create_directory(file("server"));
    server_.emplace(command_of(Words{(programs / "understudy").string(), "serve", "-n", "2", "--socket",
                                     socket(), "--listen", ":0"} +
                               options),
                    file("server"));
    std::smatch found;
    std::string said;
    ASSERT_TRUE(comes_true([&] {
      said = server_->out();
      return std::regex_search(said, found, std::regex("also at (127\\.0\\.0\\.1:[0-9]+)")) ||
             !server_->running();
    }));
    ASSERT_TRUE(server_->running()) << server_->err();
    address_ = found[1];
  }
  std::string socket() const { return file("nodes.sock").string(); }
  std::string secret() const { return file("secret").string(); }
  Words over_tcp(const std::string& key = "secret") const { return at(address_, key); }
  Words at(const std::string& address, const std::string& key = "secret") const {
    return {"--connect", address, "--secret-file", file(key).string()};
  }
  Words turning(const std::string& name, int frames) const {
    return engine_viewer("table",
                         {"--frames", std::to_string(frames), "--orbit", "3", "--screenshot", file(name)});
  }
  Words frame(const std::string& name) const {
    return engine_viewer("table", {"--azimuth", "40", "--screenshot", file(name)});
  }
  void end_server() {
    server_->signal(SIGTERM);
    EXPECT_EQ(server_->finish().status, 0) << server_->err();
    server_.reset();
    EXPECT_EQ(leftovers(), "");
  }

  /// Children of the server and their children, except mpirun's.
  std::vector<pid_t> listener_and_its_children() const {
    std::vector<pid_t> found;
    for (const pid_t process : processes("understudy"))
      if (process != server_->pid()) found.push_back(process);
    return found;
  }
  static std::size_t descriptors_of(pid_t process) {
    std::error_code gone;
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(fmt::format("/proc/{}/fd", process), gone))
      ++count;
    return count;
  }
  std::size_t descriptors() const {
    std::size_t count = descriptors_of(server_->pid());
    for (const pid_t process : listener_and_its_children()) count += descriptors_of(process);
    return count;
  }
  static std::ptrdiff_t shared_memory() { return std::distance(fs::directory_iterator("/dev/shm"), {}); }

  std::optional<Child> server_;
  std::string address_;
};

TEST_F(OverTcp, NodesDrawWhatTheyDrawAtAUnixSocket) {
  serve();
  struct stat status {};
  ASSERT_EQ(stat(secret().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0600U);
  run_well(under({"--connect", socket()}) + frame("unix.png"));
  const Outcome outcome =
      run_well(under(over_tcp() + Words{"--report", file("report.json")}) + frame("tcp.png"));
  const nlohmann::json report = json("report.json");
  EXPECT_EQ(substituted(report), 1) << outcome.err;
  EXPECT_EQ(report.at("connection").at("address"), address_);
  EXPECT_GT(report.at("connection").at("up").at("payload_bytes"), 256 * 256 * 110);
  fmt::print("{}\n", report.at("connection").dump());
  EXPECT_EQ(png("unix.png").rgb, png("tcp.png").rgb);
  run_well(under(over_tcp() + Words{"--pixels", "byte"}) + frame("byte.png"));
  EXPECT_GE(told("pixels of a byte", png("unix.png"), png("byte.png")).psnr, 45);
  // The same for a volume in a file.
  const Words render = {
      (programs / "understudy").string(), "render", "synthetic:40x40x40", "--size", "97x61", "--out"};
  run_well(render + Words{file("u.png").string(), "--connect", socket()});
  run_well(render + Words{file("t.png").string()} + over_tcp());
  EXPECT_EQ(png("u.png").rgb, png("t.png").rgb);
  end_server();
}

TEST_F(OverTcp, VolumesOfNodesAreVerifiedThoughMovingViewsTravelAsJpeg) {
  serve();
  constexpr int frames = 12;
  const auto bytes_down = [&](const Words& options) {
    const Outcome outcome = run_well(under(over_tcp() + Words{"--report", file("report.json")} + options) +
                                     turning("turned.png", frames));
    EXPECT_EQ(substituted(json("report.json")), frames) << outcome.err;
    return json("report.json").at("connection").at("down").at("payload_bytes").get<int>();
  };
  const int exact = bytes_down({});
  const int lossy = bytes_down({"--quality", "30"});
  fmt::print("bytes down: {} without loss, {} with JPEG\n", exact, lossy);
  EXPECT_LT(lossy, exact);
  end_server();
}

TEST_F(OverTcp, WhoHasAnotherSecretDrawsByItselfAndSaysWhy) {
  serve();
  std::ofstream(file("wrong")) << "what somebody made up";
  chmod(file("wrong").c_str(), 0600);
  const Outcome wrong =
      run_well(under(over_tcp("wrong") + Words{"--report", file("report.json")}) + frame("own.png"));
  EXPECT_THAT(wrong.err, HasSubstr("copy its --secret-file"));
  EXPECT_TRUE(comes_true([&] { return server_->err().find("was not let in") != std::string::npos; }));
  EXPECT_EQ(json("report.json").at("connection"), nullptr);
  // In this case, and without a GL server, a viewer without OpenGL is not started.
  const Outcome none = run(under(Words{"--remote"} + over_tcp("wrong")) + frame("none.png"));
  EXPECT_EQ(none.status, 1) << none.err;
  EXPECT_FALSE(fs::exists(file("none.png")));
  const Outcome no_gl_server = run(under(Words{"--remote"} + over_tcp()) + frame("none.png"));
  EXPECT_EQ(no_gl_server.status, 1);
  EXPECT_THAT(no_gl_server.err, HasSubstr("--gl-server"));
  const Outcome without = run(under({"--connect", address_}) + frame("none.png"));
  EXPECT_EQ(without.status, 2);
  EXPECT_THAT(without.err, HasSubstr("needs --secret-file"));
  end_server();
}

TEST_F(OverTcp, KeysServeInPlaceOfASecret) {
  const std::string understudy = (programs / "understudy").string();
  for (const char* name : {"server.key", "mine.key", "other.key"})
    run_well({understudy, "key", file(name).string()});
  EXPECT_NE(run({understudy, "key", file("mine.key").string()}).status, 0);
  fs::copy_file(file("mine.key.pub"), file("clients"));
  serve_with({"--key", file("server.key").string(), "--clients", file("clients").string()});
  const auto render = [&](const std::string& key, const std::string& server_key) {
    return run({understudy, "render", "synthetic:20x20x20", "--size", "32x32", "--out",
                file("keys.png").string(), "--connect", address_, "--key", file(key).string(), "--server-key",
                file(server_key).string()});
  };
  EXPECT_EQ(render("mine.key", "server.key.pub").status, 0);
  EXPECT_TRUE(fs::exists(file("keys.png")));
  EXPECT_THAT(render("other.key", "server.key.pub").err, HasSubstr("does not know the key"));
  EXPECT_NE(render("mine.key", "other.key.pub").status, 0);
  run_well(under({"--connect", address_, "--key", file("mine.key").string(), "--server-key",
                  file("server.key.pub").string(), "--report", file("report.json")}) +
           frame("run.png"));
  EXPECT_EQ(substituted(json("report.json")), 1);
  // No secret was generated.
  EXPECT_FALSE(fs::exists(secret()));
  end_server();
}

TEST_F(OverTcp, AThousandConnectionsLeaveNothingAtTheServer) {
  serve();
  run_well(under(over_tcp()) + frame("before.png"));
  const auto quiet = [&] { return listener_and_its_children().size() == 1; };
  ASSERT_TRUE(comes_true(quiet));
  const std::size_t before = descriptors();
  const auto memory_before = shared_memory();
  {
    using namespace understudy::compositor;
    const TcpAddress address = tcp_address_of(address_).value();
    std::vector<FileDescriptor> crowd;
    for (int i = 0; i < 1000; ++i) {
      crowd.push_back(connect_to(address, Clock::now() + std::chrono::seconds(20)));
      const std::string words = i % 2 == 0 ? "GET / HTTP/1.0\r\n\r\n" : std::string(200, 'x');
      if (i % 3 != 0) ::send(crowd.back().get(), words.data(), words.size(), MSG_NOSIGNAL);
      if (i == 500) run_well(under(over_tcp()) + frame("beside.png"));
    }
    run_well(under(over_tcp()) + frame("after.png"));
  }
  EXPECT_EQ(png("before.png").rgb, png("beside.png").rgb);
  EXPECT_EQ(png("before.png").rgb, png("after.png").rgb);
  EXPECT_TRUE(comes_true([&] { return quiet() && descriptors() <= before; }))
      << descriptors() << " of " << before;
  // Other programs on the machine may create and remove segments as well.
  EXPECT_TRUE(comes_true([&] { return shared_memory() <= memory_before; }));
  end_server();
}

TEST_F(OverTcp, AStageDrawsForViewersWithoutOpenGL) {
  serve({"--gl-server"});
  const Words without_opengl = {"env", "LIBGL_DRIVERS_PATH=/nowhere"};
  run_well(under({"--remote", "-n", "2"}) + without_opengl + frame("local.png"), {{"DISPLAY", ""}});
  const Outcome outcome = run_well(under(Words{"--remote", "--report", file("report.json")} + over_tcp()) +
                                       without_opengl + frame("tcp.png"),
                                   {{"DISPLAY", ""}});
  const nlohmann::json report = json("report.json");
  EXPECT_EQ(report.at("remote"), true) << outcome.err;
  EXPECT_GT(report.at("connection").at("up").at("bytes"), 100'000);
  EXPECT_EQ(png("local.png").rgb, png("tcp.png").rgb);
  end_server();
}

TEST_F(OverTcp, ALineThatStandsStillForThreeSecondsIsWaitedFor) {
  serve({"--gl-server"});
  for (const Words& remote : {Words{"--remote"}, Words{}}) {
    const int frames = 40;
    run_well(under(remote + over_tcp()) + turning("flowing.png", frames));
    Line line(understudy::compositor::tcp_address_of(address_).value());
    fs::create_directories(file("held"));
    Child child(command_of(under(remote + at(line.address().text()) + Words{"--report", file("report.json")}) +
                           turning("held.png", frames)),
                file("held"));
    // Probably in the middle of an image.
    EXPECT_TRUE(comes_true([&] { return line.bytes_down() > 600'000 || !child.running(); }));
    ASSERT_TRUE(child.running()) << line.bytes_down() << " bytes came\n" << child.err();
    line.stand_still();
    std::this_thread::sleep_for(std::chrono::seconds(3));
    EXPECT_TRUE(child.running()) << child.err();
    line.go_on();
    const Outcome outcome = child.finish();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(png("flowing.png").rgb, png("held.png").rgb) << outcome.err;
    if (remote.empty()) {
      EXPECT_EQ(substituted(json("report.json")), frames) << outcome.err;
    }
  }
  end_server();
}

TEST_F(OverTcp, AfterACutViewersDrawByThemselvesOrSayThatNobodyDraws) {
  serve({"--gl-server"});
  run_well(turning("bare.png", 40));
  const std::size_t processes_before = listener_and_its_children().size(), descriptors_before = descriptors();
  const auto quiet = [&] {
    return listener_and_its_children().size() == processes_before && descriptors() <= descriptors_before;
  };
  for (const Words& remote : {Words{}, Words{"--remote"}}) {
    Line line(understudy::compositor::tcp_address_of(address_).value());
    fs::create_directories(file("cut"));
    Child child(command_of(under(remote + at(line.address().text()) + Words{"--report", file("report.json")}) +
                           turning("cut.png", 40)),
                file("cut"));
    EXPECT_TRUE(comes_true([&] { return line.bytes_down() > 600'000 || !child.running(); }));
    ASSERT_TRUE(child.running()) << line.bytes_down() << " bytes came\n" << child.err();
    line.cut();
    const Outcome outcome = child.finish();
    if (remote.empty()) {
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      const int drawn_there = substituted(json("report.json"));
      EXPECT_GT(drawn_there, 0);
      EXPECT_LT(drawn_there, 40);
      EXPECT_EQ(png("bare.png").rgb, png("cut.png").rgb) << outcome.err;
    } else {
      EXPECT_THAT(outcome.err, HasSubstr("the GL server, which draws"));
    }
    EXPECT_TRUE(comes_true(quiet)) << server_->err();
  }
  // Later clients are not affected.
  run_well(under(Words{"--remote"} + over_tcp()) + frame("after.png"));
  EXPECT_EQ(png("after.png").width, 256);
  end_server();
}

TEST_F(OverTcp, JpegWhileTheViewTurnsAndEveryBitOnceItRests) {
  if (const std::string lacking = missing({Need::x_server}); !lacking.empty()) GTEST_SKIP() << lacking;
  const auto display = viewer_test::VirtualDisplay::start();
  ASSERT_TRUE(display) << "Xvfb does not start";
  serve({"--gl-server"});
  const auto bytes_down = [&](const std::string& name, const Words& options) {
    run_well(under(Words{"--remote", "--report", file(name + ".json")} + over_tcp() + options) +
                 Words{TURNS_AND_RESTS, file(name), "12"},
             {{"DISPLAY", display->name()}});
    return json(name + ".json").at("connection").at("down").at("payload_bytes").get<int>();
  };
  const int exact = bytes_down("exact", {});
  const int lossy = bytes_down("lossy", {"--quality", "40"});
  fmt::print("bytes down: {} as they are, {} with JPEG\n", exact, lossy);
  // On a machine so busy that frames are further apart than rest_after, exact pixels follow each frame: the
  // number of bytes depends on the load.
  EXPECT_NE(contents(file("lossy.turning")), contents(file("exact.turning")));
  EXPECT_EQ(contents(file("lossy")), contents(file("exact")));
  end_server();
}

}  // namespace
}  // namespace clients
