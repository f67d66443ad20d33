// SPDX-License-Identifier: Apache-2.0
// `run --export` of whole viewers, and `render` of what was exported, without the viewer.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/clients/command_test.h"
#include "tests/clients/remote_viewer.h"

namespace clients {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const Words exported_view = {"--azimuth", "35", "--elevation", "25", "--no-frame"};

class Export : public CommandTest {
 protected:
  Words render(const fs::path& scene, const Words& options) const {
    return Words{(programs / "understudy").string(), "render", scene.string()} + options;
  }
};

class ExportedMode : public Export, public testing::WithParamInterface<const char*> {};

TEST_P(ExportedMode, IsRenderedAsTheViewerDrewIt) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  const std::string mode = GetParam();
  run_well(engine_viewer(mode, exported_view + Words{"--screenshot", file("bare.png")}));
  run_well(under() + engine_viewer(mode, exported_view + Words{"--screenshot", file("under.png")}));
  const Outcome outcome = run_well(
      under({"--export", file("scenes"), "--report", file("report.json")}) +
      engine_viewer(mode, exported_view + Words{"--frames", "2", "--screenshot", file("exporting.png")}));
  EXPECT_THAT(outcome.err, HasSubstr((file("scenes") / "scene.json").string()));
  EXPECT_EQ(json("report.json").at("volumes").at(0).at("export").at("scene"), "scene.json");
  EXPECT_EQ(png("exporting.png").rgb, png("under.png").rgb) << "exporting changes no image";
  for (const char* const name : {"scene.json", "volume.nhdr", "volume.raw", "image.pfm", "image.png"})
    EXPECT_TRUE(fs::exists(file("scenes") / name)) << name;
  EXPECT_FALSE(fs::exists(file("scenes") / "scene_2.json"));
  EXPECT_GE(told("image.png and what was shown", png("scenes/image.png"), png("under.png")).psnr, 45);

  std::vector<Words> nodes = {{}};
  if (missing({Need::mpi}).empty()) nodes.push_back({"-n", "2"});
  for (const Words& own_nodes : nodes) {
    const Outcome rendered =
        run_well(render(file("scenes") / "scene.json", own_nodes + Words{"--out", file("rendered.png")}));
    EXPECT_THAT(rendered.out, HasSubstr(own_nodes.empty() ? "in this process" : "2 nodes"));
    EXPECT_GE(
        told(mode + ", the viewer's own image and the scene's", png("bare.png"), png("rendered.png")).psnr, 45);
  }
  EXPECT_EQ(leftovers(), "");
}

INSTANTIATE_TEST_SUITE_P(, ExportedMode, testing::Values("rgba", "table", "core", "preint"),
                         [](const auto& info) { return std::string(info.param); });

TEST_F(Export, OfTwoVolumesIsTwoScenes) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  run_well(under({"--export", file("scenes")}) + engine_viewer("rgba", exported_view + Words{"--second"}));
  for (const char* const name : {"scene", "scene_2"}) {
    run_well(
        render(file("scenes") / (std::string(name) + ".json"), {"--out", file(std::string(name) + ".png")}));
    const std::string image = std::string(name) == "scene" ? "scenes/image.png" : "scenes/image_2.png";
    EXPECT_GE(told(name, png(std::string(name) + ".png"), png(image)).psnr, 45);
  }
  EXPECT_LT(told("the two", png("scene.png"), png("scene_2.png")).psnr, 40);
}

TEST_F(Export, KeepsWhatOpaqueGeometryHides) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  run_well(under({"--export", file("scenes")}) + engine_viewer("core", exported_view + Words{"--opaque"}));
  const fs::path scene = file("scenes") / "scene.json";
  run_well(render(scene, {"--out", file("again.png")}));
  EXPECT_GE(told("with what hides it", png("again.png"), png("scenes/image.png")).psnr, 60);
  nlohmann::json changed = nlohmann::json::parse(contents(scene));
  ASSERT_TRUE(changed.at("request").at("depth").is_object()) << "something hides it";
  changed.at("request").at("depth") = nullptr;
  std::ofstream(scene) << changed;
  run_well(render(scene, {"--out", file("whole.png")}));
  EXPECT_LT(told("without", png("whole.png"), png("scenes/image.png")).psnr, 40);
}

class ExportOfAGlServer : public RemoteViewer {};

TEST_F(ExportOfAGlServer, IsWrittenFromItsSandbox) {
  start_display({Need::x_server, Need::engine});
  if (!display_) return;
  const Outcome outcome = run_well(under({"--remote", "--export", file("scenes")}) + without_opengl() +
                                       viewer("table", {"--no-frame", "--frames", "2"}),
                                   on_display());
  EXPECT_THAT(outcome.err, HasSubstr("scene.json"));
  run_well({(programs / "understudy").string(), "render", file("scenes") / "scene.json", "--out",
            file("again.png")});
  EXPECT_GE(told("scene and image of a GL server", png("again.png"), png("scenes/image.png")).psnr, 45);
  for (const auto& entry : fs::directory_iterator(file("scenes")))
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Export, IsRefusedBeforeTheViewerStartsIfTheFolderCannotBeWritten) {
  folder_.write("occupied", std::string("a file"));
  const Outcome outcome = run(under({"--export", file("occupied")}) + Words{"touch", file("started").string()});
  EXPECT_EQ(outcome.status, 2) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("--export: "), HasSubstr(file("occupied").string())));
  EXPECT_FALSE(fs::exists(file("started")));
}

TEST_F(Export, SaysWhyThereIsNoScene) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  const Outcome stacks = run_well(under({"--export", file("scenes")}) + engine_viewer("stacks", exported_view));
  EXPECT_THAT(stacks.err, HasSubstr("no scene was exported: it is a stack of 2-D textures"));
  const Outcome none = run_well(under({"--export", file("scenes")}) + Words{"true"});
  EXPECT_THAT(none.err, HasSubstr("no scene was exported: no volume was substituted"));
  EXPECT_TRUE(fs::is_empty(file("scenes")));
}

TEST_F(Export, RefusesScenesThatAreDamagedAndOptionsThatHaveNoEffect) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  run_well(under({"--export", file("scenes")}) + engine_viewer("table", exported_view));
  const fs::path scene = file("scenes") / "scene.json";
  const std::string whole = contents(scene);
  const Words out = {"--out", file("out.png").string()};
  const auto said = [&](const Words& options) {
    const Outcome outcome = run(render(scene, options + out));
    EXPECT_NE(outcome.status, 0);
    EXPECT_LT(outcome.status, 128) << "no crash";
    EXPECT_FALSE(fs::exists(file("out.png")));
    return outcome.err;
  };
  EXPECT_THAT(said({"--camera", "1,2,3"}), AllOf(HasSubstr("--camera"), HasSubstr("no effect")));
  nlohmann::json changed = nlohmann::json::parse(whole);
  changed.at("request").erase("filter");
  std::ofstream(scene) << changed;
  EXPECT_THAT(said({}), HasSubstr("'request.filter' is missing"));
  changed = nlohmann::json::parse(whole);
  changed.at("request").at("texture_to_clip") = std::vector<double>(16, 0.0);
  std::ofstream(scene) << changed;
  EXPECT_THAT(said({}), HasSubstr("singular"));
  std::ofstream(scene) << whole.substr(0, whole.size() / 2);
  EXPECT_THAT(said({}), HasSubstr("not valid JSON"));
  std::ofstream(scene) << whole;
  fs::resize_file(file("scenes") / "volume.raw", 1000);
  EXPECT_THAT(said({}), AllOf(HasSubstr("volume.raw"), HasSubstr("1000 bytes")));
  fs::remove(file("scenes") / "volume.raw");
  EXPECT_THAT(said({}), HasSubstr("No such file"));
}

}  // namespace
}  // namespace clients
