// SPDX-License-Identifier: Apache-2.0
// Requests of pages: every key is parsed, invalid requests are refused, and accepted ones can be drawn.
#include "apps/understudy/view/view_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "apps/understudy/view/view_state.h"
#include "compositor/rendered.h"
#include "volume/request.h"

namespace understudy::launcher {
namespace {

using ::testing::HasSubstr;

const std::string everything =
    R"({"sequence": 7, "still": false, "lossless": true, "took_ms": 12.5, "size": [320, 200],
        "camera": {"azimuth": 10, "elevation": -20, "distance": 3, "roll": 5, "shift": [0.1, -0.2]},
        "rotate": [[0, 0], [0.1, 0.2]], "pan": [0.3, 0.4], "zoom": {"by": 2, "at": [0.5, 0.6]},
        "table": {"knots": [{"at": 0, "colour": [0, 0, 0], "opacity": 0},
                            {"at": 1, "colour": [1, 0.5, 0.25], "opacity": 0.5}]},
        "volume": false, "surfaces": [{"at": 0.4, "colour": [1, 0, 0], "opacity": 0.5}], "light": true,
        "step": 2, "time_step": 1})";

std::string refusal(const std::string& text) {
  try {
    decode_view_message(text);
  } catch (const MalformedView& error) {
    return error.what();
  }
  return "(believed)";
}

FileScene some_scene() {
  SceneArguments arguments;
  arguments.volumes = {"synthetic:24x20x16:u8:lobes", "synthetic:24x20x16:u8:shells"};
  FileScene scene = scene_of(arguments);
  widen_ghost_layer(scene);
  return scene;
}

TEST(ViewMessage, EveryKeyArrives) {
  const ViewMessage message = decode_view_message(everything);
  EXPECT_EQ(message.sequence, 7U);
  EXPECT_FALSE(message.still);
  EXPECT_EQ(message.lossless, true);
  EXPECT_EQ(message.took_ms, 12.5);
  EXPECT_EQ(message.size, (std::array{320, 200}));
  EXPECT_EQ(message.camera, (ViewCamera{{10, -20, 3, 5}, {0.1, -0.2}}));
  EXPECT_EQ(message.rotate, (std::array<ImagePoint, 2>{{{0, 0}, {0.1, 0.2}}}));
  EXPECT_EQ(message.pan, (ImagePoint{0.3, 0.4}));
  ASSERT_TRUE(message.zoom);
  EXPECT_EQ(message.zoom->by, 2);
  EXPECT_EQ(message.zoom->at, (ImagePoint{0.5, 0.6}));
  ASSERT_TRUE(message.table);
  EXPECT_EQ(message.table->control_points.at(1).opacity, 0.5);
  EXPECT_EQ(message.shows_volume, false);
  EXPECT_EQ(message.time_step, 1);
  ASSERT_TRUE(message.surfaces);
  EXPECT_EQ(message.surfaces->at(0).at, 0.4);
  EXPECT_EQ(message.light, true);
  EXPECT_EQ(message.step, 2);
  EXPECT_TRUE(decode_view_message("{}").still);
}

TEST(ViewMessage, WhatCannotBeBelievedIsRefusedByItsKey) {
  EXPECT_THAT(refusal("no JSON"), HasSubstr("not a JSON object"));
  EXPECT_THAT(refusal("[1]"), HasSubstr("not a JSON object"));
  EXPECT_THAT(refusal(R"({"size": [1e9, 100]})"), HasSubstr("'size' is not between 16 and 4096"));
  EXPECT_THAT(refusal(R"({"size": [100]})"), HasSubstr("'size' is not a list of 2"));
  EXPECT_THAT(refusal(R"({"step": 1e999})"), HasSubstr("JSON"));
  EXPECT_THAT(refusal(R"({"step": 0})"), HasSubstr("'step'"));
  EXPECT_THAT(refusal(R"({"zoom": {"by": -1, "at": [0, 0]}})"), HasSubstr("'zoom'"));
  EXPECT_THAT(refusal(R"({"zoom": 5})"), HasSubstr("'zoom' has no 'by'"));
  EXPECT_THAT(refusal(R"({"camera": {"azimuth": 1, "elevation": 91}})"), HasSubstr("'camera'"));
  EXPECT_THAT(refusal(R"({"table": {"knots": []}})"), HasSubstr("not a transfer function"));
  EXPECT_THAT(refusal(R"({"table": {"knots": 3}})"), HasSubstr("not a transfer function"));
  EXPECT_THAT(refusal(R"({"surfaces": [{"at": 2, "colour": [0, 0, 0], "opacity": 1}]})"),
              HasSubstr("'surfaces'"));
  EXPECT_THAT(refusal(R"({"run": "rm -rf /"})"), HasSubstr("an unknown key"));
  std::string control_points = R"({"table": {"knots": [)";
  for (int i = 0; i < 1025; ++i)
    control_points += std::string(i > 0 ? "," : "") + R"({"at":0.5,"colour":[0,0,0],"opacity":0})";
  EXPECT_THAT(refusal(control_points + "]}}"), HasSubstr("more than 1024 control points"));
  EXPECT_THAT(refusal(std::string(max_view_message_bytes + 1, ' ')), HasSubstr("exceeds the limit"));
  EXPECT_THAT(refusal(std::string(max_view_message_bytes, '[')), HasSubstr("not a JSON object"));
}

TEST(ViewMessage, DamagedMessagesAreRefusedOrCanBeDrawn) {
  constexpr unsigned seed = 815;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const FileScene scene = some_scene();
  volume::TexelFigures values;
  values.low = 0;
  values.high = 255;
  ViewState state(scene);
  int refused = 0, believed = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text = everything;
    for (unsigned i = 1 + random() % 3; i > 0; --i) text[random() % text.size()] = char(' ' + random() % 95);
    ViewMessage message;
    try {
      message = decode_view_message(text);
    } catch (const MalformedView&) {
      ++refused;
      continue;
    }
    try {
      state.apply(message);
    } catch (const MalformedView&) {
      ++refused;
      EXPECT_GT(message.time_step, 1);
      continue;
    }
    ++believed;
    const volume::RenderRequest request = state.request(scene, values);
    for (const double value : request.texture_to_clip) ASSERT_TRUE(std::isfinite(value)) << text;
    ASSERT_LE(request.window.pixels(), std::size_t(most_view_side) * most_view_side);
  }
  std::printf("%d refused, %d believed\n", refused, believed);
  EXPECT_GT(refused, 1000);
  EXPECT_GT(believed, 100);
}

TEST(ViewState, ImagesThatMoveAreAsLargeAsTheirTimeAllows) {
  ViewState state(some_scene());
  ViewMessage moving;
  moving.still = false;
  moving.size = {1000, 800};
  state.apply(moving);
  EXPECT_EQ(state.size(), (std::array{1000, 800})) << "nothing is known yet";
  state.took({1000, 800}, 4 * ViewState::moving_ms);
  EXPECT_EQ(state.size(), (std::array{500, 400}));
  // A quarter of the pixels took a quarter of the time, so the size stays.
  moving.took_ms = ViewState::moving_ms;
  state.took(state.size(), ViewState::moving_ms);
  state.apply(moving);
  EXPECT_NEAR(state.size()[0], 500, 1);
  // Images get faster, and therefore large again.
  for (int i = 0; i < 30; ++i) {
    state.took(state.size(), 1);
    moving.took_ms = 1;
    state.apply(moving);
  }
  EXPECT_EQ(state.size(), (std::array{1000, 800}));
  // Images get very slow, but there is still an image.
  for (int i = 0; i < 30; ++i) {
    state.took(state.size(), 1e6);
    moving.took_ms = 1e6;
    state.apply(moving);
  }
  EXPECT_EQ(state.size(), (std::array{166, 133}));
  state.apply({});
  EXPECT_EQ(state.size(), (std::array{1000, 800})) << "at rest all of it";
}

TEST(ViewState, TheGhostLayerIsWideEnoughForWhateverMayBeAsked) {
  const FileScene scene = some_scene();
  volume::TexelFigures values;
  values.low = 0;
  values.high = 255;
  for (const bool light : {false, true})
    for (const bool surface : {false, true})
      for (const double step : {least_view_step, most_view_step}) {
        ViewState state(scene);
        ViewMessage message;
        message.light = light;
        message.step = step;
        if (surface) message.surfaces = {SurfaceChoice{0.5, true, {1, 1, 1, 1}}};
        state.apply(message);
        const auto service = compositor::embedded_loading_service();
        auto ranks = service->begin_load(scene.load);
        while (!ranks[0].done()) ranks = service->continue_load(scene.load.volume.id);
        EXPECT_NO_THROW(service->render(state.request(scene, values))) << light << surface << step;
      }
}

}  // namespace
}  // namespace understudy::launcher
