// SPDX-License-Identifier: Apache-2.0
// Viewers on the test's own X server, without OpenGL of their own.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "tests/apps/viewer/virtual_display.h"
#include "tests/clients/command_test.h"

namespace clients {

class RemoteViewer : public CommandTest {
 protected:
  /// If no display is started, the test is skipped or has failed afterwards.
  void start_display(std::initializer_list<Need> needs) {
    if (const std::string lacking = missing(needs); !lacking.empty()) GTEST_SKIP() << lacking;
    auto started = viewer_test::VirtualDisplay::start();
    ASSERT_TRUE(started) << "Xvfb does not start";
    display_.emplace(std::move(*started));
  }

  /// The bundled viewer in a window.
  Words viewer(const std::string& mode, const Words& options) const {
    return Words{(programs / "understudy-viewer").string(),
                 engine_file().string(),
                 "--mode",
                 mode,
                 "--window-size",
                 "256",
                 "256",
                 "--azimuth",
                 "40",
                 "--elevation",
                 "30"} +
           options;
  }
  std::map<std::string, std::string> on_display() const { return {{"DISPLAY", display_->name()}}; }
  /// Without a driver: loading one fails here.
  static Words without_opengl() { return {"env", "LIBGL_DRIVERS_PATH=/nowhere"}; }

  /// What the X server shows; nullopt if it cannot be grabbed.
  std::optional<viewer_test::Image> screen() const {
    const Words grab = {"import", "-window", "root", "png24:" + file("screen.png").string()};
    if (Child({grab, on_display()}, file("")).finish().status != 0) return std::nullopt;
    return png("screen.png");
  }

  std::optional<viewer_test::VirtualDisplay> display_;
};

}  // namespace clients
