// SPDX-License-Identifier: Apache-2.0
// Desktop menu entries that start a viewer under Understudy.
#include "apps/understudy/desktop/desktop_entry.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "tests/compositor/scratch_folder.h"

namespace understudy::launcher {
namespace {

TEST(DesktopEntry, RunsItsProgramsUnderUnderstudy) {
  const std::string entry =
      "[Desktop Entry]\nType=Application\nName=ParaView\nName[de]=ParaView\nTryExec=paraview\n"
      "Exec=paraview %f\nMimeType=application/x-paraview;\nActions=empty;\n\n"
      "[Desktop Action empty]\nName=Without a file\nExec=paraview --empty\n";
  EXPECT_EQ(under_understudy(entry, "/opt/under study/bin/understudy", {"-n", "4", "--error=2/255"}),
            "[Desktop Entry]\nType=Application\nName=ParaView (Understudy)\nName[de]=ParaView (Understudy)\n"
            "Exec=\"/opt/under study/bin/understudy\" run -n 4 --error=2/255 -- paraview %f\nActions=empty;\n\n"
            "[Desktop Action empty]\nName=Without a file\n"
            "Exec=\"/opt/under study/bin/understudy\" run -n 4 --error=2/255 -- paraview --empty\n");
}

TEST(DesktopEntry, WordsAreQuotedAsTheSpecificationHasThem) {
  const std::string text = under_understudy("[Desktop Entry]\nExec=a\n", "/u", {"100%", "a\"b", "$HOME"});
  EXPECT_EQ(text, "[Desktop Entry]\nExec=/u run 100%% \"a\\\\\"b\" \"\\\\$HOME\" -- a\n");
}

TEST(DesktopEntry, WhatStartsNothingIsRefused) {
  EXPECT_THROW(under_understudy("[Desktop Entry]\nType=Link\nURL=https://example.org\n", "/u", {}),
               std::runtime_error);
}

TEST(DesktopEntry, IsFoundByTheNameOfItsFile) {
  const compositor::testing::ScratchFolder folder;
  const std::filesystem::path shared = folder / "shared";
  std::filesystem::create_directories(shared / "applications");
  std::ofstream(shared / "applications" / "org.paraview.ParaView.desktop") << "";
  setenv("XDG_DATA_HOME", (folder / "own").c_str(), 1);
  setenv("XDG_DATA_DIRS", shared.c_str(), 1);
  EXPECT_EQ(find_desktop_entry("paraview"), shared / "applications" / "org.paraview.ParaView.desktop");
  EXPECT_EQ(find_desktop_entry("view"), std::nullopt);
  unsetenv("XDG_DATA_HOME");
  unsetenv("XDG_DATA_DIRS");
}

}  // namespace
}  // namespace understudy::launcher
