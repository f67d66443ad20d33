// SPDX-License-Identifier: Apache-2.0
// Exported scenes as text: nothing that the image depends on is lost, and a text that is damaged or made up is
// refused with the key that is wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "compositor/scene/colour_map.h"
#include "compositor/scene/exported_scene.h"
#include "compositor/service/request_message.h"

namespace understudy::compositor {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;
using namespace volume;

RaySteps all_of_the_steps() {
  RaySteps steps;
  steps.metric = {1, 2, 3, 4, 5, 6, 7, 8, 10};
  steps.first = 0.1;
  steps.divided = true;
  steps.rounding = 0.25;
  steps.past_depth = 2;
  steps.offsets = RayOffsets{3, 2, {0, 0.5F, 0.1F, 0.125F, 1, 2}};
  steps.counted_from = 1.0 / 3;
  steps.at_least_one = true;
  steps.cover_whole_ray = true;
  return steps;
}

Light all_of_the_light() {
  Light light;
  light.space = {1, 2, 3, 4, 5, 6, 7, 8, 10};
  light.ray_space = {{2, 0, 0, 0, 3, 0, 0, 0.1, 4}};
  light.direction = {0.1, -1, 2};
  light.ambient = {0.1F, 0.2F, 0.3F};
  light.diffuse = {0.4F, 0.5F, 0.6F};
  light.specular = {0.7F, 0.8F, 0.9F};
  light.shininess = 12;
  light.full_slope = 0.3F;
  light.guard = {0.7, NormalGuard::Form::root_of_squares};
  light.two_sided = false;
  light.on_samples = false;
  light.reach = {1.1, 2, 0.5};
  light.even = {0.5F, 0.25F, 1};
  light.brightest = 1.5F;
  light.response = {{1, -0.5F}, {0.1F, 0}, {0, 2}};
  light.gradient_opacity = {{0.2F, 1, 0.5F}, 0.125, 3};
  return light;
}

/// Every field differs from its default, although no image is made of them together.
RenderRequest everything() {
  RenderRequest r;
  r.volume = r.version = 1;
  for (std::size_t i = 0; i < 16; ++i) r.texture_to_clip[i] = 0.1 * double(i) - 0.3;
  r.viewport = {-5, 6, 700, 500};
  r.window = {0, 6, 300, 20};
  r.depth_range = {0.25, 0.7};
  r.planes = {{0.1, -0.2, 0.3}, -1.5, 1.0 / 513, 999};
  r.steps = all_of_the_steps();
  r.op = Operator::min;
  r.filter = Filter::nearest;
  r.region = {{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}};
  r.clip_planes = {{{1, 0, 0}, -0.5}, {{0, 1, 2}, 0.1}};
  r.classification = TransferFunction{-0.5F, 2.5F, {{0, 0, 0, 0}, {0.1F, 0.2F, 0.3F, 0.4F}, {9, 9, 9, 1}}};
  r.slice_segment = SliceSegment{1, {0.1, -0.2, 0.3}, {0.15, 0.25, 0.35}};
  r.fog = Fog{{0.5, -0.25, 2}, 0.1, {{0, 0, 0, 1}, {0.1F, 0.2F, 0.3F, 0.5F}}};
  r.method = Method::pre_integrated;
  r.cut_at_bricks = 4;
  r.tolerance = 0.3F;
  r.surfaces = {{0.2, {0.1F, 0.2F, 0.3F, 0.4F}}, {-7.5, {1, 0.5F, 0, 1}}};
  r.light = all_of_the_light();
  r.termination = 1e-5F;
  r.opacity_limit = 0.95F;
  r.depth = DepthImage{{2, 7, 3, 1}, {0.5F, 0.1F, 1.0F}, true};
  r.may_travel_as_halves = true;
  r.exact = true;
  r.bound_of = MediumFunction{{0, 0.5F, {{0, 0, 0, 0}, {0.1F, 0.1F, 0.1F, 0.3F}}}, 0.7};
  r.optimizations = {false, false, false};
  return r;
}

ExportedScene some_scene(RenderRequest request = everything()) {
  ExportedScene scene;
  scene.origin = {"/usr/bin/viewer", 7, "INTENSITY8", 51.5};
  scene.volume.id = scene.volume.version = 1;
  scene.volume.size = {64, 33, 17};
  scene.volume.type = TexelType::u16;
  scene.volume.wrap = {Wrap::edge, Wrap::border, Wrap::repeat};
  scene.volume.border = {0.1F, 0.2F, 0.3F, 0.4F};
  scene.volume.stored = {{1, 2, 3}, {60, 33, 17}};
  scene.volume.ghost_layer = 8;
  scene.texels = "volume.raw";
  scene.request = std::move(request);
  return scene;
}

std::string message_of(const std::string& text) {
  try {
    scene_in(text);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "accepted";
}

/// Whoever adds a field must add its name here, a value in everything(), and a line in request_fields.h.
template <class Compare>
void for_each_field(const RenderRequest& a, const RenderRequest& b, Compare compare) {
  const auto& [volume, version, texture_to_clip, viewport, window, depth_range, planes, steps, op, filter,
               region, clip_planes, classification, slice_segment, fog, method, cut_at_bricks, tolerance,
               surfaces, light, termination, opacity_limit, depth, may_travel_as_halves, exact, bound_of,
               optimizations] = a;
  const auto& [volume2, version2, texture_to_clip2, viewport2, window2, depth_range2, planes2, steps2, op2,
               filter2, region2, clip_planes2, classification2, slice_segment2, fog2, method2, cut_at_bricks2,
               tolerance2, surfaces2, light2, termination2, opacity_limit2, depth2, may_travel_as_halves2,
               exact2, bound_of2, optimizations2] = b;
  compare("texture_to_clip", texture_to_clip, texture_to_clip2);
  compare("viewport", viewport, viewport2);
  compare("window", window, window2);
  compare("depth_range", depth_range, depth_range2);
  compare("planes", planes, planes2);
  compare("steps", steps, steps2);
  compare("op", op, op2);
  compare("filter", filter, filter2);
  compare("region", region, region2);
  compare("clip_planes", clip_planes, clip_planes2);
  compare("classification", classification, classification2);
  compare("slice_segment", slice_segment, slice_segment2);
  compare("fog", fog, fog2);
  compare("method", method, method2);
  compare("cut_at_bricks", cut_at_bricks, cut_at_bricks2);
  compare("tolerance", tolerance, tolerance2);
  compare("surfaces", surfaces, surfaces2);
  compare("light", light, light2);
  compare("termination", termination, termination2);
  compare("opacity_limit", opacity_limit, opacity_limit2);
  compare("depth", depth, depth2);
  compare("may_travel_as_halves", may_travel_as_halves, may_travel_as_halves2);
  compare("exact", exact, exact2);
  compare("bound_of", bound_of, bound_of2);
  compare("optimizations", optimizations, optimizations2);
}

/// Fails to compile, like for_each_field(), when a part of a request gets another field.
void count_fields_of_parts() {
  [[maybe_unused]] const auto& [metric, first, divided, rounding, past_depth, offsets, counted_from,
                                at_least_one, cover_whole_ray] = RaySteps{};
  [[maybe_unused]] const auto& [space, ray_space, direction, ambient, diffuse, specular, shininess, full_slope,
                                guard, two_sided, on_samples, reach, even, brightest, response,
                                gradient_opacity] = Light{};
  [[maybe_unused]] const auto& [factors, first_slope, last_slope] = GradientOpacity{};
  [[maybe_unused]] const auto& [slope, form] = NormalGuard{};
  [[maybe_unused]] const auto& [diffuse_response, specular_response] = LightResponse{};
  [[maybe_unused]] const auto& [normal, first_plane, spacing, count] = SlicePlanes{};
  [[maybe_unused]] const auto& [planes, offset, segment_reach] = SliceSegment{};
  [[maybe_unused]] const auto& [fog_normal, fog_offset, fog_entries] = Fog{};
  [[maybe_unused]] const auto& [value, colour] = Surface{};
  [[maybe_unused]] const auto& [rect, depth, or_equal] = DepthImage{};
  [[maybe_unused]] const auto& [low, high, entries] = TransferFunction{};
  [[maybe_unused]] const auto& [matrix, multiply_by_alpha, alpha_above] = LinearMap{};
  [[maybe_unused]] const auto& [table_low, table_high, edge, table_entries, straight] = PreIntegrationTable{};
  [[maybe_unused]] const auto& [function, step] = MediumFunction{};
  [[maybe_unused]] const auto& [empty_bricks, dominated_samples, footprints] = Optimizations{};
  [[maybe_unused]] const auto& [id, version, size, type, wrap, border, stored, ghost_layer, part] =
      VolumeDescription{};
}

TEST(Scene, HoldsEveryFieldOfARequest) {
  count_fields_of_parts();
  const RenderRequest sent = everything();
  for_each_field(sent, RenderRequest{}, [](const char* name, const auto& a, const auto& b) {
    EXPECT_FALSE(a == b) << name << " is set";
  });
  const ExportedScene got = scene_in(scene_text(some_scene()));
  for_each_field(sent, got.request,
                 [](const char* name, const auto& a, const auto& b) { EXPECT_TRUE(a == b) << name; });
  EXPECT_EQ(got.request, sent);
  EXPECT_EQ(encode(got.request), encode(sent)) << "bit by bit";
  EXPECT_EQ(got.volume, some_scene().volume);
  EXPECT_EQ(got.texels, "volume.raw");
  EXPECT_EQ(got.origin.program, "/usr/bin/viewer");
  EXPECT_EQ(got.origin.frame, 7U);
  EXPECT_EQ(got.origin.texture_format, "INTENSITY8");
  EXPECT_EQ(got.origin.psnr, 51.5);
}

TEST(Scene, HoldsWhatIsAbsentEveryClassificationAndUnboundedLight) {
  RenderRequest plain;
  plain.volume = plain.version = 1;
  plain.viewport = plain.window = {0, 0, 4, 4};
  plain.light.emplace();
  LinearMap map;
  for (std::size_t i = 0; i < 16; ++i) map.matrix[i] = float(i) / 7;
  map.multiply_by_alpha = false;
  map.alpha_above = 0.02F;
  PreIntegrationTable table{-0.5F, 2.5F, 3, {}, false};
  for (int i = 0; i < 9; ++i) table.entries.push_back({float(i) / 3, 0.5F, 0.25F, 0.125F});
  for (const Classification& each : {Classification(TransferFunction{0, 1, {{}, {1, 1, 1, 1}}}),
                                     Classification(map), Classification(table)}) {
    plain.classification = each;
    EXPECT_EQ(scene_in(scene_text(some_scene(plain))).request, plain) << each.index();
  }
}

TEST(Scene, IsNotWrittenWithValuesThatJsonLacks) {
  RenderRequest request = everything();
  request.termination = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(scene_text(some_scene(request)), SceneError);
  request = everything();
  request.depth->depth[1] = -std::numeric_limits<float>::infinity();
  EXPECT_THROW(scene_text(some_scene(request)), SceneError);
}

TEST(Scene, CutOffAnywhereIsRefused) {
  const std::string text = scene_text(some_scene());
  const std::size_t end = text.find_last_of('}');
  for (std::size_t length = 0; length <= end; ++length)
    ASSERT_THAT(message_of(text.substr(0, length)), testing::Not("accepted")) << length;
  EXPECT_EQ(message_of(text), "accepted");
}

using Pointer = ordered_json::json_pointer;

/// Calls `visit` with the place of every key of an object inside `json`, however deep.
void for_each_key(const ordered_json& json, const Pointer& here,
                  const std::function<void(const Pointer&)>& visit) {
  for (auto member = json.begin(); member != json.end(); ++member) {
    if (json.is_object()) visit(here / member.key());
    if (member->is_object()) for_each_key(*member, here / member.key(), visit);
  }
}

TEST(Scene, WithoutAKeyIsRefusedByItsName) {
  const ordered_json whole = ordered_json::parse(scene_text(some_scene()));
  int keys = 0;
  for_each_key(whole, Pointer(), [&](const Pointer& key) {
    if (key.to_string().starts_with("/origin")) return;
    ordered_json without = whole;
    without.at(key.parent_pointer()).erase(key.back());
    EXPECT_THAT(message_of(without.dump()), HasSubstr(key.back())) << key.to_string();
    ++keys;
  });
  EXPECT_GT(keys, 100);
}

TEST(Scene, WithValuesOfOtherTypesIsRefusedByTheKeysName) {
  const ordered_json whole = ordered_json::parse(scene_text(some_scene()));
  for_each_key(whole, Pointer(), [&](const Pointer& key) {
    if (key.to_string().starts_with("/origin")) return;
    for (const char* const wrong :
         {"\"x\"", "{}", "[[1]]", "[]", "-1.5", "99999999999999999999", "1e308", "true"}) {
      ordered_json changed = whole;
      changed.at(key) = ordered_json::parse(wrong);
      if (changed.at(key).type() == whole.at(key).type()) continue;
      const std::string message = message_of(changed.dump());
      // Numbers stand for other numbers, whatever their sign and size, and may be within the limits.
      EXPECT_THAT(message, testing::AnyOf("accepted", HasSubstr(key.back())))
          << key.to_string() << ": " << wrong;
      const bool number = changed.at(key).is_number() && (whole.at(key).is_number() || whole.at(key).is_null());
      EXPECT_TRUE(message != "accepted" || number) << key.to_string() << ": " << wrong;
    }
  });
}

struct Wrong {
  const char* place;
  const char* value;
  const char* said;
};

TEST(Scene, WithValuesOutOfRangeIsRefused) {
  const ordered_json whole = ordered_json::parse(scene_text(some_scene()));
  for (const Wrong& wrong : {
           Wrong{"/version", "2", "'version' is 2"},
           Wrong{"/format", "\"other\"", "'format'"},
           Wrong{"/texels", "\"../volume.raw\"", "'texels'"},
           Wrong{"/texels", "\"/etc/passwd\"", "'texels'"},
           Wrong{"/texels", "\"..\"", "'texels'"},
           Wrong{"/texels", "\"\"", "'texels'"},
           Wrong{"/volume/size", "[1000000, 33, 17]", "size.x"},
           Wrong{"/volume/size", "[64, 0, 17]", "size.y"},
           Wrong{"/volume/size", "[64, 33, -1]", "size.z"},
           Wrong{"/volume/size", "[4294967360, 33, 17]", "volume.size"},
           Wrong{"/volume/size", "[18446744073709551615, 33, 17]", "volume.size"},
           Wrong{"/volume/size", "[64, 33]", "'volume.size' is not a list of 3"},
           Wrong{"/volume/stored/high", "[65, 33, 17]", "stored.high.x"},
           Wrong{"/volume/type", "\"u64\"", "'volume.type' is none of: u8, u16, f32, rgba8"},
           Wrong{"/request/window/width", "1000000", "window"},
           Wrong{"/request/planes/count", "2147483647", "planes.count"},
           Wrong{"/request/steps/offsets/width", "4", "steps.offsets"},
           Wrong{"/request/classification/entries", "[[0, 0, 0, 0]]", "classification.entries"},
           Wrong{"/request/classification/entries", "[[0, 0, 0]]", "classification.entries"},
           Wrong{"/request/classification/low", "1e39", "classification.low"},
           Wrong{"/request/classification/kind", "\"other\"", "classification.kind"},
           Wrong{"/request/light/guard/form", "7", "light.guard.form"},
           Wrong{"/request/cut_at_bricks", "256", "cut_at_bricks"},
           Wrong{"/request/depth/depth", "[1]", "depth.depth"},
       }) {
    ordered_json changed = whole;
    changed.at(Pointer(wrong.place)) = ordered_json::parse(wrong.value);
    EXPECT_THAT(message_of(changed.dump()), HasSubstr(wrong.said)) << wrong.place << ": " << wrong.value;
  }
}

TEST(Scene, OfOtherJsonIsRefused) {
  for (const char* const text : {"", "null", "[]", "{}", "1", "{\"format\": 1}", "nan", "{\"format\": NaN}",
                                 "{\"format\": 1e999}", "\xff\xfe", "{\"format\": \"understudy-scene\"}"})
    EXPECT_NE(message_of(text), "accepted") << text;
  EXPECT_NE(message_of(std::string(1000000, '[')), "accepted");
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

TEST(Scene, NestedTooDeeplyIsRefusedWhereverItIs) {
  constexpr std::size_t deep = 200000;
  const std::string nested = repeated("[", deep) + repeated("]", deep);
  const std::string objects = repeated("{\"a\":", deep) + "1" + repeated("}", deep);
  for (const std::string& value : {nested, objects}) {
    EXPECT_THAT(message_of("{\"format\": " + value + "}"), HasSubstr("nested deeper"));
    EXPECT_THAT(message_of("{\"format\": \"understudy-scene\", \"version\": " + value + "}"),
                HasSubstr("nested deeper"));
    EXPECT_THAT(message_of(value), HasSubstr("nested deeper"));
  }
  EXPECT_THAT(message_of("{\"format\": \"understudy-scene\", \"version\": [[1]]}"),
              HasSubstr("'version' is not a number"));
}

TEST(Scene, WithTooManyKeysOrPartsIsRefused) {
  std::string keys;
  for (int i = 0; i < 65; ++i) keys += fmt::format("{}\"{}\": 0", i > 0 ? ", " : "", i);
  EXPECT_THAT(message_of("{\"origin\": {" + keys + "}}"), HasSubstr("more than 64 keys"));
  EXPECT_THAT(message_of("{\"origin\": [" + repeated("{}, ", (1U << 20U)) + "{}]}"),
              HasSubstr("lists or objects"));
}

TEST(ColourMap, HasPlainColoursAndOpacitiesAtTheValuesOfTexels) {
  const TransferFunction function{0, 1, {{0, 0, 0, 0}, {0.25F, 0.125F, 0, 0.5F}, {1, 0, 1, 1}}};
  const auto map = ordered_json::parse(*paraview_colour_map(function, TexelType::u8)).at(0);
  EXPECT_EQ(map.at("ColorSpace"), "RGB");
  EXPECT_EQ(map.at("RGBPoints").get<std::vector<double>>(),
            (std::vector<double>{0, 0.5, 0.25, 0, 127.5, 0.5, 0.25, 0, 255, 1, 0, 1}))
      << "what is invisible has the next visible colour";
  EXPECT_EQ(map.at("Points").get<std::vector<double>>(),
            (std::vector<double>{0, 0, 0.5, 0, 127.5, 0.5, 0.5, 0, 255, 1, 0.5, 0}));
  EXPECT_TRUE(map.at("Name").is_string());
}

TEST(ColourMap, OfLongTransferFunctionsHasFewPointsAndTheirEnds) {
  TransferFunction function{-2, 6, std::vector<Rgba>(5000, {0.5F, 0.5F, 0.5F, 0.5F})};
  function.entries.back() = {0.25F, 0, 0, 1};
  const auto map = ordered_json::parse(*paraview_colour_map(function, TexelType::f32)).at(0);
  const auto points = map.at("RGBPoints").get<std::vector<double>>();
  ASSERT_EQ(points.size(), 4U * max_colour_map_points);
  EXPECT_EQ(points.front(), -2);
  EXPECT_EQ(std::vector<double>(points.end() - 4, points.end()), (std::vector<double>{6, 0.25, 0, 0}));
}

TEST(ColourMap, OfSegmentsIsThatOfConstantOnesAndOfColoursThereIsNone) {
  PreIntegrationTable table{0, 1, 2, {{1, 0, 0, 0.5F}, {9, 9, 9, 9}, {9, 9, 9, 9}, {0, 1, 0, 0.25F}}, true};
  const auto map = ordered_json::parse(*paraview_colour_map(table, TexelType::u16)).at(0);
  EXPECT_EQ(map.at("RGBPoints").get<std::vector<double>>(), (std::vector<double>{0, 1, 0, 0, 65535, 0, 1, 0}));
  EXPECT_FALSE(paraview_colour_map(LinearMap{}, TexelType::rgba8).has_value());
}

}  // namespace
}  // namespace understudy::compositor
