// SPDX-License-Identifier: Apache-2.0
// Viewers without OpenGL: a GL server executes their calls, and the images equal those of a viewer on a machine
// with OpenGL.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "tests/clients/remote_viewer.h"

namespace clients {
namespace {

class Remote : public RemoteViewer {
 protected:
  void SetUp() override { start_display({Need::engine, Need::x_server, Need::imagemagick}); }

  void expect_same_images(const std::string& mode, const Words& nodes) {
    const auto frames = [&](const std::string& folder) {
      return viewer(mode, {"--frames", "2", "--orbit", "50", "--screenshot-frames", file(folder)});
    };
    run_well(under(nodes) + frames("local"), on_display());
    const Outcome outcome = run_well(
        under(nodes + Words{"--remote", "--report", file("report.json")}) + without_opengl() + frames("remote"),
        on_display());
    const nlohmann::json report = json("report.json");
    EXPECT_EQ(report.at("remote"), true);
    EXPECT_EQ(report.at("frames"), 2);
    EXPECT_EQ(substituted(report), 2) << outcome.err;
    EXPECT_EQ(report.at("server_connection").at("frames"), 2);
    EXPECT_GT(report.at("server_connection").at("bytes_up"), 256 * 256 * 110);
    fmt::print("{}: {}\n", mode, report.at("server_connection").dump());
    for (const char* name : {"frame_0000.png", "frame_0001.png"}) {
      EXPECT_GE(told(fmt::format("{}, {}", mode, name), png(fmt::format("local/{}", name)),
                     png(fmt::format("remote/{}", name)))
                    .psnr,
                50);
    }
  }

  static bool shows_something(const viewer_test::Image& image) {
    return std::set<std::uint8_t>(image.rgb.begin(), image.rgb.end()).size() > 16;
  }

  void expect_images_in_the_window(bool by_shared_memory) {
    viewer_test::Image local;
    {
      Child child(command_of(under() + viewer("table", {}), on_display()), file(""));
      ASSERT_TRUE(comes_true([&] {
        const viewer_test::Image before = local;
        local = screen().value_or(before);
        return !local.rgb.empty() && local.rgb == before.rgb && shows_something(local);
      })) << child.err();
      child.signal(SIGTERM);
      EXPECT_EQ(child.finish().status, 128 + SIGTERM);
    }
    Child child(command_of(under({"--remote"}) + without_opengl() + viewer("table", {}), on_display()),
                file(""));
    const bool shown = comes_true([&] {
      const auto now = screen();
      return !child.running() || (now && now->rgb == local.rgb);
    });
    EXPECT_TRUE(shown && child.running()) << child.err();
    const std::vector<pid_t> viewers = processes("understudy-viewer");
    ASSERT_EQ(viewers.size(), 1U);
    const std::string mapped = contents(fmt::format("/proc/{}/maps", viewers.front()));
    EXPECT_NE(mapped.find("libunderstudy.so"), std::string::npos);
    for (const char* of_a_driver : {"libGLdispatch", "libGLX_", "libEGL_", "_dri.so", "libLLVM"})
      EXPECT_EQ(mapped.find(of_a_driver), std::string::npos) << of_a_driver;
    EXPECT_EQ(mapped.find("/memfd:understudy-image") != std::string::npos, by_shared_memory);
    child.signal(SIGTERM);
    EXPECT_EQ(child.finish().status, 128 + SIGTERM);
    EXPECT_EQ(leftovers(), "");
  }
};

TEST_F(Remote, ShowsWhatIsShownWhereOpenGLIs) {
  expect_same_images("table", {});
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Remote, CoreContextsAndNodes) {
  if (const std::string lacking = missing({Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  expect_same_images("core", {"-n", "2"});
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Remote, PolygonsInTilesAreThoseOfOneProcess) {
  if (const std::string lacking = missing({Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  const auto frames = [&](const std::string& tiles) {
    // A solid that extends into the volume: its depth is read from all tiles.
    const Outcome outcome = run_well(
        under({"-n", "2", "--remote", "--tiles", tiles, "--report", file("report.json")}) + without_opengl() +
            viewer("table", {"--frames", "3", "--orbit", "50", "--opaque", "--screenshot-frames",
                             file("tiles_" + tiles)}),
        on_display());
    EXPECT_EQ(substituted(json("report.json")), 3) << outcome.err;
    EXPECT_EQ(outcome.err.find("was killed by signal"), std::string::npos) << outcome.err;
    return json("report.json").at("tiles");
  };
  EXPECT_EQ(frames("off"), nullptr);
  const nlohmann::json tiles = frames("on");
  EXPECT_EQ(tiles.at("of"), 2);
  EXPECT_EQ(tiles.at("frames"), 3);
  EXPECT_EQ(tiles.at("given_up"), "");
  for (const char* name : {"frame_0000.png", "frame_0001.png", "frame_0002.png"})
    EXPECT_EQ(png(fmt::format("tiles_off/{}", name)).rgb, png(fmt::format("tiles_on/{}", name)).rgb) << name;
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Remote, PerfShowsWhichCallsWaitForTheGlServer) {
  const std::string chain = fmt::format("perf(file={}) pack remote", file("calls.json").string());
  run_well(under({"--remote", "--chain", chain, "--report", file("report.json")}) + without_opengl() +
               viewer("table", {"--frames", "2"}),
           on_display());
  EXPECT_EQ(substituted(json("report.json")), 2);
  const nlohmann::json perf = json("calls.json");
  const auto all = perf.at("all").at("round_trips").get<std::uint64_t>();
  EXPECT_GT(all, 0U);
  // Contexts, swaps and their ends wait for replies as well.
  EXPECT_LE(all, json("report.json").at("server_connection").at("round_trips").get<std::uint64_t>());
  EXPECT_GT(perf.at("calls").at("glGetString").at("round_trips"), 0);
  EXPECT_EQ(perf.at("calls").at("glClear").at("round_trips"), 0);
}

TEST_F(Remote, TilesAreForGlServers) {
  const Outcome outcome = run(under({"--tiles", "on"}) + Words{"true"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("add --remote"), std::string::npos) << outcome.err;
}

TEST_F(Remote, OffScreen) {
  const auto frame = [&](const std::string& name) {
    return engine_viewer("table", {"--azimuth", "40", "--screenshot", file(name)});
  };
  run_well(under() + frame("local.png"));
  const Outcome outcome =
      run_well(under({"--remote", "--report", file("report.json")}) + without_opengl() + frame("remote.png"),
               {{"DISPLAY", ""}});
  EXPECT_EQ(substituted(json("report.json")), 1) << outcome.err;
  EXPECT_GE(told("off screen", png("local.png"), png("remote.png")).psnr, 50);
}

TEST_F(Remote, AForkedChildThatExitsLeavesTheGlServerToItsParent) {
  const Words forks = {FORKS, "child_only_exits"};
  const Outcome local = run_well(under() + forks);
  const Outcome remote = run_well(under({"--remote"}) + without_opengl() + forks);
  EXPECT_NE(local.out.find("parent, after a swap"), std::string::npos) << local.out;
  EXPECT_EQ(remote.out, local.out) << remote.err;
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Remote, WhatStaysTheSameDoesNotTravel) {
  const auto bytes_up = [&](const char* frames) {
    run_well(under({"--remote", "--report", file("report.json")}) + viewer("table", {"--frames", frames}),
             on_display());
    return json("report.json").at("server_connection").at("bytes_up").get<double>();
  };
  const double a_frame = (bytes_up("30") - bytes_up("10")) / 20;
  fmt::print("a frame of a view that rests: {:.0f} bytes up\n", a_frame);
  EXPECT_LT(a_frame, 4096);
}

TEST_F(Remote, ImagesAreInTheWindow) {
  expect_images_in_the_window(true);
}

TEST_F(Remote, ImagesAreInTheWindowOfAServerWithoutSharedMemory) {
  display_.reset();
  display_.emplace(std::move(*viewer_test::VirtualDisplay::start("MIT-SHM")));
  expect_images_in_the_window(false);
}

/// A field of /proc/PID/status, such as "Seccomp_filters".
std::string status_of(pid_t process, const std::string& name) {
  const std::string text = contents(fmt::format("/proc/{}/status", process));
  const std::size_t at = text.find("\n" + name + ":\t");
  if (at == std::string::npos) return {};
  const std::size_t from = at + name.size() + 3;
  return text.substr(from, text.find('\n', from) - from);
}

TEST_F(Remote, ItsCallsAreMadeInASandboxUnlessThatIsSwitchedOff) {
  const auto filters_of_this_test = std::stoi(status_of(::getpid(), "Seccomp_filters"));
  for (const bool wanted : {true, false}) {
    Child child(command_of(under({"--remote", "--sandbox", wanted ? "auto" : "off"}) +
                               viewer("table", {"--frames", "100000", "--orbit", "1"}),
                           {{"DISPLAY", display_->name()}, {"A_SECRET", "of the server's user"}}),
                file(""));
    // It draws, so the sandbox is closed.
    pid_t drawing = 0;
    ASSERT_TRUE(comes_true([&] {
      for (const pid_t process : processes("understudy")) {
        if (contents(fmt::format("/proc/{}/cmdline", process)).find("--client") != std::string::npos)
          drawing = process;
      }
      const auto now = screen();
      return !child.running() || (drawing != 0 && now && shows_something(*now));
    })) << child.err();
    ASSERT_TRUE(child.running()) << child.err();
    EXPECT_EQ(std::stoi(status_of(drawing, "Seccomp_filters")), filters_of_this_test + int(wanted));
    if (wanted) {
      EXPECT_EQ(status_of(drawing, "NoNewPrivs"), "1");
    }
    const std::string environment = contents(fmt::format("/proc/{}/environ", drawing));
    EXPECT_EQ(environment.find("A_SECRET") == std::string::npos, wanted);
    child.signal(SIGTERM);
    EXPECT_EQ(child.finish().status, 128 + SIGTERM);
    EXPECT_EQ(child.err().find("without a sandbox"), std::string::npos) << child.err();
  }
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Remote, FramesAreSavedFromTheSandbox) {
  const Outcome outcome = run_well(under({"--remote", "--save-frames", file("frames")}) + without_opengl() +
                                       viewer("table", {"--frames", "2"}),
                                   on_display());
  // Without Landlock, files would not be restricted to that folder.
  const bool has_none = outcome.err.find("files cannot be written") != std::string::npos;
  EXPECT_NE(std::filesystem::exists(file("frames") / "frame_0001.pfm"), has_none) << outcome.err;
}

TEST_F(Remote, AStageThatIsKilledIsSaidOnce) {
  Child child(
      command_of(under({"--remote"}) + viewer("table", {"--frames", "100000", "--orbit", "1"}), on_display()),
      file(""));
  // The listening GL server, and its process for the viewer.
  const auto servers = [&] {
    std::vector<pid_t> found;
    for (const pid_t process : processes("understudy")) {
      if (process != child.pid()) found.push_back(process);
    }
    return found;
  };
  // Waits until the viewer draws: if a GL server is lost before, the viewer starts without OpenGL.
  ASSERT_TRUE(comes_true([&] {
    const auto now = screen();
    return !child.running() || (now && shows_something(*now) && servers().size() == 2);
  })) << child.err();
  for (const pid_t process : servers()) kill(process, SIGKILL);
  EXPECT_TRUE(comes_true([&] { return child.err().find("the GL server, which draws") != std::string::npos; }))
      << child.err();
  child.signal(SIGTERM);
  EXPECT_EQ(child.finish().status, 128 + SIGTERM);
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Remote, AViewerThatIsKilledEndsItsGlServer) {
  Child child(
      command_of(under({"--remote"}) + viewer("table", {"--frames", "100000", "--orbit", "1"}), on_display()),
      file(""));
  ASSERT_TRUE(comes_true([&] {
    const auto now = screen();
    return !child.running() || (now && shows_something(*now));
  })) << child.err();
  for (const pid_t process : processes("understudy-viewer")) kill(process, SIGKILL);
  EXPECT_EQ(child.finish().status, 128 + SIGKILL);
  EXPECT_EQ(leftovers(), "");
}

}  // namespace
}  // namespace clients
