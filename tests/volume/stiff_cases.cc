// SPDX-License-Identifier: Apache-2.0
#include "tests/volume/stiff_cases.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "volume/image.h"

namespace understudy::volume::testing {
namespace {

Texture usual_noise() {
  return noise(describe({33, 17, 21}, TexelType::u8), 5);
}

RenderRequest usual_request(const Texture& texture) {
  return request_for(texture, usual_camera(37, 31), 37, 31, 60);
}

TransferFunction table_of(const std::function<float(int)>& opacity, float colour = 0.75F, int entries = 256) {
  TransferFunction table;
  for (int i = 0; i < entries; ++i) {
    const float a = opacity(i);
    table.entries.push_back({colour * a, 0.5F * colour * a, a * float(i) / float(entries), a});
  }
  return table;
}

StiffCase with_table(std::string name, TransferFunction table, double bound = 5e-5, double apart = 1e-5) {
  Texture texture = usual_noise();
  RenderRequest request = usual_request(texture);
  request.classification = std::move(table);
  return {std::move(name), std::move(texture), std::move(request), bound, apart};
}

/// For bytes, the ray caster's weights have 14 bits; a step from one of 256 entries to the next amplifies their
/// error 255 times. For floats about 1e-6 remains.
constexpr double bound_of_steps_in_bytes = 255.0 / (1 << 14);
constexpr double bound_of_steps_in_floats = 2e-3;

StiffCase in_floats(const StiffCase& bytes) {
  StiffCase floats = bytes;
  floats.name += "InFloats";
  floats.texture = noise(describe({33, 17, 21}, TexelType::f32), 5);
  floats.bound = bound_of_steps_in_floats;
  return floats;
}

StiffCase with_texture(std::string name, Texture texture) {
  RenderRequest request = usual_request(texture);
  return {std::move(name), std::move(texture), std::move(request)};
}

StiffCase with_camera(std::string name, const Matrix4& camera, double bound = 5e-5,
                      std::array<int, 2> size = {37, 31}) {
  Texture texture = usual_noise();
  RenderRequest request = request_for(texture, camera, size[0], size[1], 60);
  return {std::move(name), std::move(texture), std::move(request), bound};
}

Matrix4 eye_at(const Vec3& eye, const Vec3& centre, double near = 0.01, double far = 10) {
  return multiply(perspective(60, 37.0 / 31, near, far),
                  multiply(look_at(eye, centre, {0.1, 1, 0.3}), unit_cube()));
}

}  // namespace

std::vector<StiffCase> stiff_tables() {
  std::vector<StiffCase> cases;
  // Optical depth per sample from 1e-12 to 1e12, and infinite.
  for (int exponent = -12; exponent <= 12; exponent += 3) {
    const auto opacity = float(-std::expm1(-std::pow(10.0, exponent)));
    cases.push_back(with_table(
        "OpticalDepth1e" + std::string(exponent < 0 ? "Minus" : "") + std::to_string(std::abs(exponent)),
        table_of([opacity](int) { return opacity; })));
  }
  cases.push_back(with_table("OpticalDepthInfinite", table_of([](int) { return 1.0F; })));
  const std::vector<std::pair<std::string, std::function<float(int)>>> steps{
      {"Step", [](int i) { return i < 128 ? 0.0F : 1.0F; }},
      {"BoxOfOneValue", [](int i) { return i == 128 ? 0.9F : 0.0F; }},
      {"Comb", [](int i) { return i % 2 == 0 ? 0.0F : 1.0F; }}};
  for (const auto& [name, opacity] : steps) {
    cases.push_back(with_table(name, table_of(opacity), bound_of_steps_in_bytes, 1e-5));
    cases.push_back(in_floats(cases.back()));
  }
  // With 4,096 entries the factor is 4,095; only float texels permit a bound.
  StiffCase spike = in_floats(with_table("SpikeNarrowerThanASample",
                                         table_of([](int i) { return i == 1250 ? 1.0F : 0.0F; }, 0.75F, 4096)));
  spike.bound = 16 * bound_of_steps_in_floats;
  cases.push_back(std::move(spike));
  cases.push_back(with_table("Clear", table_of([](int) { return 0.0F; }), 0, 0));
  TransferFunction glow = table_of([](int i) { return float(i) / 2560; });
  for (Rgba& entry : glow.entries) entry[3] = 0;
  cases.push_back(with_table("GlowWithoutOpacity", glow));
  // 8-bit blending would lose the first fog and double the second; Understudy preserves both.
  cases.push_back(with_table("FogUnderHalfAByte", table_of([](int) { return 1.0F / 1000; })));
  cases.push_back(with_table("FogUnderAByte", table_of([](int) { return 1.0F / 400; })));
  return cases;
}

std::vector<StiffCase> stiff_fields() {
  std::vector<StiffCase> cases;
  cases.push_back(
      with_texture("Constant", sampled(describe({33, 17, 21}, TexelType::u8), constant_field(0.6))));
  for (const std::array<int, 3> size : {std::array{1, 19, 23},
                                        {19, 1, 23},
                                        {19, 23, 1},
                                        {1, 1, 23},
                                        {1, 23, 1},
                                        {23, 1, 1},
                                        {1, 1, 1},
                                        {2, 3, 5},
                                        {9, 8, 7},
                                        {8, 8, 8},
                                        {17, 16, 15}}) {
    const std::string name =
        "Size" + std::to_string(size[0]) + "x" + std::to_string(size[1]) + "x" + std::to_string(size[2]);
    for (const auto& [type, type_name] : {std::pair{TexelType::u8, "U8"}, {TexelType::f32, "F32"}})
      cases.push_back(with_texture(name + type_name, noise(describe(size, type), 6)));
  }
  for (const auto& [type, type_name] : {std::pair{TexelType::u8, "U8"}, {TexelType::u16, "U16"}})
    cases.push_back(with_texture(std::string("ExtremesOf") + type_name,
                                 sampled(describe({33, 17, 21}, type), [](const Vec3& t) {
                                   return std::fmod(std::floor(t[0] * 33) + std::floor(t[1] * 17), 2);
                                 })));
  return cases;
}

std::vector<StiffCase> stiff_views() {
  std::vector<StiffCase> cases;
  cases.push_back(with_camera("EyeInside", eye_at({0.11, 0.07, 0.13}, {0, 0, -0.5})));
  cases.push_back(with_camera("EyeOnAFace", eye_at({0.1, 0.05, 0.5}, {0, 0, 0})));
  cases.push_back(with_camera("EyeOnAnEdge", eye_at({0.5, 0.05, 0.5}, {0, 0, 0})));
  cases.push_back(with_camera("EyeOnACorner", eye_at({0.5, 0.5, 0.5}, {0, 0, 0})));
  // Blocks end at texel centres, 8 cells after the first centre.
  cases.push_back(with_camera("EyeOnABlocksFace", eye_at({8.5 / 33 - 0.5, 0.05, 0.13}, {0.3, 0, -0.5})));
  cases.push_back(with_camera("RaysAlongTheFaces", multiply(parallel(0.7, 0.6, -2, 2), unit_cube())));
  cases.push_back(
      with_camera("RaysThroughEdges", multiply(parallel(37.0 / 64, 31.0 / 64, -2, 2), unit_cube())));
  cases.push_back(with_camera("NearPlaneCutsTheVolume", eye_at({0.9, 0.7, 1.2}, {0, 0, 0}, 1.4)));
  cases.push_back(with_camera("NearToFarIs1eMinus6To1e6", eye_at({0.9, 0.7, 1.2}, {0, 0, 0}, 1e-6, 1e6), 2e-4));
  const auto model = [](const Matrix4& m) {
    return multiply(usual_camera(37, 31), multiply(inverse(unit_cube()).value(), multiply(m, unit_cube())));
  };
  cases.push_back(with_camera("Mirrored", model({-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})));
  cases.push_back(with_camera("Sheared", model({1, 0.6, 0, 0, 0, 1, 0.4, 0, 0.3, 0, 1, 0, 0, 0, 0, 1})));
  const Matrix4 flat{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0, 1};
  StiffCase sheet = with_camera("Anisotropy1To1e6", model(flat));
  // Slices that face the viewer would almost all miss it.
  sheet.request.planes = {{0, 0, -1}, -0.98, 0.0475, 21};
  cases.push_back(std::move(sheet));
  Matrix4 away = unit_cube();
  for (const std::size_t k : {3, 7, 11}) away[k] += 1e7;
  cases.push_back(with_camera(
      "WorldOffset1e7",
      multiply(perspective(40, 37.0 / 31, 0.1, 10),
               multiply(look_at({1e7 + 0.9, 1e7 + 0.7, 1e7 + 1.6}, {1e7, 1e7, 1e7}, {0, 1, 0}), away)),
      2e-4));
  cases.push_back(with_camera("Viewport1x1", usual_camera(1, 1), 5e-5, {1, 1}));
  cases.push_back(with_camera("Viewport16384x1", usual_camera(37, 31), 5e-5, {16384, 1}));
  return cases;
}

void expect_within_bounds(const StiffCase& one, const char* renderer, const DrawBricks& draw) {
  const Field field = texture_field(one.texture.description, one.request.filter, one.texture.texels);
  double from_reference = 0, apart = 0, shown = 0;
  for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add}) {
    RenderRequest request = one.request;
    request.op = op;
    const Image whole = render_whole(one.texture, request, draw).image;
    ASSERT_TRUE(std::ranges::all_of(whole.rgba, [](float v) { return std::isfinite(v); })) << one.name;
    const ReferenceImage expected = slice_sum(field, request, request.window);
    const double largest = *std::ranges::max_element(expected.rgba);
    if (op == Operator::over) shown = largest;
    // The error of sums grows with their size.
    const double unit = op == Operator::add ? std::max(1.0, largest) : 1;
    from_reference = std::max(from_reference, difference(whole, expected).max / unit);
    apart = std::max(apart, difference(render_parts(one.texture, request, 4, draw).image, whole).max / unit);
    if (op != Operator::over) continue;
    for (std::size_t p = 0; p < whole.rgba.size(); p += 4) {
      ASSERT_GE(whole.rgba[p + 3], 0) << one.name;
      ASSERT_LE(whole.rgba[p + 3], 1) << one.name;
    }
  }
  std::printf(
      "| %-4s | %-28s | from the reference %.1e | bound %.0e | four ranks from one %.1e | bound %.0e |\n",
      renderer, one.name.c_str(), from_reference, one.bound, apart, one.apart);
  EXPECT_EQ(shown > 0, one.bound > 0) << one.name << ": an empty image tests nothing";
  EXPECT_LE(from_reference, one.bound) << one.name;
  EXPECT_LE(apart, one.apart) << one.name;
}

}  // namespace understudy::volume::testing
