// SPDX-License-Identifier: Apache-2.0
// `understudy view` as a whole: its images equal those of `understudy render`, whatever viewers and nodes do.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <numeric>
#include <thread>

#include "apps/understudy/view/web_client.h"
#include "tests/apps/render/render_command.h"
#include "tests/apps/view/view_process.h"
#include "tests/apps/viewer/virtual_display.h"

namespace understudy::launcher {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

const std::string volume_name = "synthetic:40x36x32:u8:lobes";

class View : public Render {
 protected:
  RgbaImage decoded(const std::string& png) const {
    const std::string path = folder_.write("shown.png", std::as_bytes(std::span(png)));
    return read_image(path);
  }
  RgbaImage rendered(const std::string& arguments) const {
    const Result result = render(arguments);
    EXPECT_EQ(result.status, 0) << arguments << ": " << result.output;
    return read_image(folder_.file("p.png"));
  }
};

double greatest_difference(const RgbaImage& a, const RgbaImage& b) {
  if (a.width != b.width || a.height != b.height) return 1e300;
  double greatest = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    greatest = std::max(greatest, double(std::abs(a.rgba[i] - b.rgba[i])));
  return greatest;
}

double brightest(const RgbaImage& image) {
  double most = 0;
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (i % 4 != 3) most = std::max(most, double(image.rgba[i]));
  return most;
}

/// Authenticates the client; afterwards it can request images.
Json greeted(WebClient& client, const ViewProcess& process) {
  client.greet(process.secret());
  return client.wait_for("volume").json;
}

const Json some_camera{{"azimuth", -50}, {"elevation", 35}, {"distance", 3}, {"roll", 12}, {"shift", {0, 0}}};

TEST_F(View, AtRestABrowserHasTheImageOfRender) {
  const ViewProcess process({volume_name, "--transfer-function", "rainbow", "--size", "200x150"});
  WebClient client(process.port());
  const Json volume = greeted(client, process);
  EXPECT_EQ(volume.at("nodes"), 0);
  const WebClient::Message first = client.image({});
  EXPECT_EQ(first.json.at("format"), "png");
  const RgbaImage shown = decoded(first.image);
  EXPECT_GT(brightest(shown), 0.2);
  const std::string common = volume_name + " --size 200x150 ";
  EXPECT_EQ(greatest_difference(shown, rendered(common + "--transfer-function rainbow")), 0);
  EXPECT_EQ(greatest_difference(decoded(client.image({{"camera", some_camera}}).image),
                                rendered(common + "--transfer-function rainbow --camera=-50,35,3,12")),
            0);
  // A transfer function from the page, light, a surface and another step.
  const Json table{{"knots", volume.at("tables").at("engine")}};
  EXPECT_EQ(greatest_difference(
                decoded(client.image({{"table", table}, {"light", true}, {"step", 0.5}}).image),
                rendered(common + "--transfer-function engine --camera=-50,35,3,12 --light all --step 0.5")),
            0);
  const Json surface{{"at", 0.5}, {"colour", {1, 128 / 255.0, 0}}, {"opacity", 1}};
  const Json surface_alone{{"surfaces", Json::array({surface})}, {"volume", false}, {"step", 1}};
  EXPECT_EQ(greatest_difference(
                decoded(client.image(surface_alone).image),
                rendered(common + "--surface 50%,#ff8000 --no-volume --camera=-50,35,3,12 --light all")),
            0);
}

TEST_F(View, TheVolumeSaysItsValuesAndEveryTexelOnce) {
  const ViewProcess process({volume_name, "-n", "3", "--sort", "last"});
  WebClient client(process.port());
  const Json volume = greeted(client, process);
  EXPECT_EQ(volume.at("size"), (Json{40, 36, 32}));
  EXPECT_EQ(volume.at("nodes"), 3);
  const auto counts = volume.at("histogram").at("counts").get<std::vector<std::uint64_t>>();
  EXPECT_LE(counts.size(), 256U);
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::uint64_t(0)), 40U * 36U * 32U);
  EXPECT_GT(counts.front(), 0U);
  EXPECT_GT(counts.back(), 0U);

  const Json head = client.image({{"size", {128, 96}}}).json;
  Json figures = client.wait_for("figures").json;
  EXPECT_FALSE(figures.contains("error")) << "the error follows";
  while (figures.value("rays", 0) < 20) figures = client.wait_for("figures").json;
  EXPECT_EQ(figures.at("sequence"), head.at("sequence"));
  EXPECT_GT(figures.at("error"), 0);
  EXPECT_LT(figures.at("error"), 0.1);
  ASSERT_EQ(figures.at("ranks").size(), 3U);
  double volume_of_boxes = 0;
  std::uint64_t samples = 0;
  for (const Json& rank : figures.at("ranks")) {
    double box = 1;
    for (std::size_t k = 0; k < 3; ++k) box *= double(rank.at("box")[1][k]) - double(rank.at("box")[0][k]);
    volume_of_boxes += box;
    samples += rank.at("samples").get<std::uint64_t>();
    EXPECT_GT(rank.at("ms"), 0);
  }
  EXPECT_NEAR(volume_of_boxes, 1, 1e-9) << "the boxes tile the volume";
  EXPECT_EQ(samples, head.at("samples"));
}

TEST_F(View, WhileItMovesTheNewestCameraWinsAndNothingQueuesUp) {
  const ViewProcess process({volume_name, "--size", "400x400"});
  WebClient client(process.port());
  greeted(client, process);
  constexpr int requests = 200;
  for (int i = 1; i <= requests; ++i)
    client.send({{"sequence", i}, {"still", i == requests}, {"rotate", {{0, 0}, {0.01, 0.003}}}});
  int images = 0;
  std::string last;
  for (int sequence = 0; sequence < requests;) {
    const WebClient::Message message = client.wait_for("image");
    EXPECT_GT(message.json.at("sequence"), sequence) << "never an older one";
    sequence = message.json.at("sequence");
    EXPECT_EQ(message.json.at("format"), sequence == requests ? "png" : "jpeg");
    last = message.image;
    ++images;
  }
  std::printf("%d images for %d requests\n", images, requests);
  EXPECT_LT(images, requests);
  // All movements must be included in the final camera.
  const Json camera = client.image({}).json.at("camera");
  EXPECT_EQ(
      greatest_difference(decoded(last),
                          rendered(volume_name + " --size 400x400 --camera=" +
                                   fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}", double(camera.at("azimuth")),
                                               double(camera.at("elevation")), double(camera.at("distance")),
                                               double(camera.at("roll"))))),
      0);
  EXPECT_GT(std::abs(double(camera.at("azimuth")) - 30), 20);
}

TEST_F(View, BrowsersHaveCamerasOfTheirOwnAndMayComeAndGoAtAnyTime) {
  const ViewProcess process({volume_name, "--size", "200x200"});
  WebClient first(process.port()), second(process.port());
  greeted(first, process);
  greeted(second, process);
  const std::string before = first.image({}).image;
  EXPECT_NE(second.image({{"camera", some_camera}}).image, before);
  EXPECT_EQ(first.image({}).image, before);
  const std::size_t descriptors = process.descriptors();
  // Pages are reloaded repeatedly while their images are being rendered or sent.
  for (int i = 0; i < 40; ++i) {
    WebClient client(process.port());
    greeted(client, process);
    client.send({{"sequence", 1}, {"size", {1500, 1500}}});
    if (i % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(i));
  }
  EXPECT_EQ(first.image({}).image, before);
  const auto end = std::chrono::steady_clock::now() + 30s;
  while (process.descriptors() > descriptors && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(10ms);
  EXPECT_LE(process.descriptors(), descriptors);
}

TEST_F(View, NonsenseIsRefusedByName) {
  const ViewProcess process({volume_name, "--size", "64x64"});
  WebClient client(process.port());
  greeted(client, process);
  client.send_text("nonsense");
  EXPECT_THAT(client.wait_for("impossible").json.at("text"), HasSubstr("not a JSON"));
  client.send({{"step", 1e9}});
  EXPECT_THAT(client.wait_for("impossible").json.at("text"), HasSubstr("'step'"));
  EXPECT_EQ(client.image({}).json.at("width"), 64);
}

std::vector<pid_t> nodes_of(pid_t launcher) {
  std::vector<pid_t> found;
  std::vector<pid_t> parents{launcher};
  for (std::size_t i = 0; i < parents.size(); ++i) {
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const std::string name = entry.path().filename();
      if (!std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; })) continue;
      std::string stat;
      std::getline(std::ifstream(entry.path() / "stat"), stat);
      const std::size_t open = stat.find('('), close = stat.rfind(')');
      if (close == std::string::npos) continue;
      if (std::stoi(stat.substr(close + 4)) != parents[i]) continue;
      parents.push_back(std::stoi(name));
      if (stat.substr(open + 1, close - open - 1) == "understudy-node") found.push_back(parents.back());
    }
  }
  return found;
}

TEST_F(View, NodesThatDieAreSaidAndReplaced) {
  const ViewProcess process({volume_name, "-n", "2", "--size", "200x150"});
  WebClient client(process.port());
  greeted(client, process);
  const RgbaImage before = decoded(client.image({{"camera", some_camera}}).image);
  EXPECT_GT(brightest(before), 0.1);
  const std::vector<pid_t> nodes = nodes_of(process.id());
  ASSERT_EQ(nodes.size(), 2U);
  kill(nodes.back(), SIGKILL);
  // The loss is detected when the next image is requested.
  client.send({{"sequence", 100}});
  const Json lost = client.wait_for("status").json;
  EXPECT_EQ(lost.at("state"), "lost");
  EXPECT_THAT(lost.at("text"), HasSubstr("The render nodes are gone"));
  std::string state;
  while (state != "ready") state = client.wait_for("status").json.at("state");
  client.wait_for("volume");
  const WebClient::Message again = client.wait_for("image");
  EXPECT_LE(greatest_difference(decoded(again.image), before), 1.01 / 255)
      << "what was asked for is answered after all";
}

TEST_F(View, AWindowSavesTheImageOfRender) {
  const auto display = viewer_test::VirtualDisplay::start();
  if (!display) GTEST_SKIP() << "Xvfb is not installed";
  for (const char* nodes : {"", "-n 2 "}) {
    const Result result = shell(
        "DISPLAY=" + display->name() + " " + UNDERSTUDY_PROGRAM + " view " + nodes + volume_name +
        " --transfer-function rainbow --size 220x160 --frames 3 --orbit 25 --save " + folder_.file("w.png"));
    ASSERT_EQ(result.status, 0) << result.output;
    EXPECT_LE(greatest_difference(read_image(folder_.file("w.png")),
                                  rendered(nodes + volume_name +
                                           " --transfer-function rainbow --size 220x160 --camera 80,20,4")),
              *nodes == '\0' ? 0 : 1.01 / 255);
  }
}

TEST_F(View, OfASeriesEveryTimeStepHasTheImageOfItsFile) {
  const std::vector<std::string> files{"synthetic:40x36x32:u8:lobes", "synthetic:40x36x32:u8:gyroid",
                                       "synthetic:40x36x32:u8:shells"};
  // Positions are values, so that the transfer function means the same in all steps.
  const std::string common = " --size 120x90 --transfer-function " +
                             folder_.write("t.json", R"({"positions": "values", "knots": [
                               {"at": 0, "colour": [0, 0, 1], "opacity": 0},
                               {"at": 255, "colour": [1, 0.5, 0], "opacity": 0.4}]})") +
                             " ";
  std::vector<RgbaImage> expected;
  expected.reserve(files.size());
  for (const std::string& file : files) expected.push_back(rendered(file + common));
  EXPECT_EQ(greatest_difference(rendered(files[0] + " " + files[1] + " " + files[2] + common + "--time-step 1"),
                                expected[1]),
            0);
  for (const char* nodes : {"0", "2"}) {
    std::vector<std::string> words = files;
    for (const char* word : {"--size", "120x90", "--transfer-function", "--time-step", "2"}) {
      words.emplace_back(word);
      if (words.back() == "--transfer-function") words.push_back(folder_.file("t.json"));
    }
    if (*nodes != '0') words.insert(words.end(), {"-n", nodes});
    const ViewProcess process(words);
    WebClient client(process.port());
    const Json volume = greeted(client, process);
    EXPECT_EQ(volume.at("time_steps"), 3);
    EXPECT_EQ(volume.at("time_step"), 2);
    for (const int step : {2, 0, 1, 2, 1}) {
      const WebClient::Message image = client.image({{"time_step", step}});
      EXPECT_EQ(image.json.at("time_step"), step);
      EXPECT_LE(greatest_difference(decoded(image.image), expected[std::size_t(step)]),
                *nodes == '0' ? 0 : 1.01 / 255)
          << step;
    }
    client.send({{"time_step", 3}});
    EXPECT_THAT(client.wait_for("impossible").json.at("text"), HasSubstr("'time_step' must be less than 3"));
  }
}

TEST_F(View, StepsOfAnotherSizeAreNoSeries) {
  const Result result = render("synthetic:40x36x32 synthetic:40x36x33 --size 32x32");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr("40 x 36 x 33"), HasSubstr("same size and type")));
  EXPECT_THAT(render("synthetic:8x8x8 --time-step 1").output, HasSubstr("there is no time step 1"));
  EXPECT_THAT(render("'" + folder_.file("none_*.vti") + "'").output, HasSubstr("no file has such a name"));
}

TEST_F(View, AWindowPlaysASeries) {
  const auto display = viewer_test::VirtualDisplay::start();
  if (!display) GTEST_SKIP() << "Xvfb is not installed";
  const std::string files = "synthetic:40x36x32:u8:lobes synthetic:40x36x32:u8:gyroid";
  const std::string common = " --transfer-function " +
                             folder_.write("t.json", R"({"positions": "values", "knots": [
                               {"at": 0, "colour": [0, 0, 1], "opacity": 0},
                               {"at": 255, "colour": [1, 0.5, 0], "opacity": 0.4}]})") +
                             " --size 120x90 ";
  const Result result = shell("DISPLAY=" + display->name() + " " + UNDERSTUDY_PROGRAM + " view " + files +
                              common + "--frames 4 --play --save " + folder_.file("w.png"));
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_EQ(
      greatest_difference(read_image(folder_.file("w.png")), rendered("synthetic:40x36x32:u8:gyroid" + common)),
      0);
}

TEST_F(View, WithoutADisplayTheWayOutIsSaid) {
  const Result result = shell(std::string("env -u DISPLAY -u WAYLAND_DISPLAY SDL_VIDEODRIVER=x11 ") +
                              UNDERSTUDY_PROGRAM + " view " + volume_name + " --frames 1");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.output, HasSubstr("give --web 0"));
}

TEST_F(View, IsACommandLikeTheOthers) {
  const std::string command = std::string(UNDERSTUDY_PROGRAM) + " view ";
  const Result help = shell(command + "--help");
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.output,
              AllOf(HasSubstr("understudy view"), HasSubstr("--web"), HasSubstr("--transfer-function")));
  const Result wrong = shell(command + volume_name + " --no-such-option");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.output, HasSubstr("--no-such-option"));
  const Result missing = shell(command + "/no/such/file.nrrd --web 0");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.output, HasSubstr("understudy: "));
}

}  // namespace
}  // namespace understudy::launcher
