// SPDX-License-Identifier: Apache-2.0
#include "tests/emulation/viewer_frame.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace emulation {
namespace {

using Json = nlohmann::json;

/// Reads the volume file in the described type and range: one value in [0,1] per voxel.
std::vector<double> read_values(const Json& volume) {
  std::ifstream file(volume.at("file").get<std::string>(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const double low = volume.at("value_at_0"), high = volume.at("value_at_1");
  const std::string type = volume.at("type");
  std::vector<double> values;
  const auto read = [&]<typename T>(T) {
    for (std::size_t i = 0; i + sizeof(T) <= bytes.size(); i += sizeof(T)) {
      T value;
      std::memcpy(&value, bytes.data() + i, sizeof(T));
      values.push_back((value - low) / (high - low));
    }
  };
  if (type == "u8") read(std::uint8_t{});
  if (type == "i16") read(std::int16_t{});
  if (type == "f32") read(float{});
  return values;
}

Factor factor_named(const std::string& name) {
  if (name == "GL_ZERO") return Factor::zero;
  if (name == "GL_ONE") return Factor::one;
  if (name == "GL_SRC_ALPHA") return Factor::source_alpha;
  if (name == "GL_ONE_MINUS_SRC_ALPHA") return Factor::one_minus_source_alpha;
  if (name == "GL_ONE_MINUS_DST_ALPHA") return Factor::one_minus_destination_alpha;
  throw std::invalid_argument("the description names the blend factor " + name + ", which the emulation lacks");
}

Matrix matrix_of(const Json& scale_and_translate) {
  const auto scale = scale_and_translate.at("scale").get<Vec3>();
  const auto translate = scale_and_translate.at("translate").get<Vec3>();
  return {scale[0], 0, 0, 0, 0, scale[1], 0, 0, 0, 0, scale[2], 0, translate[0], translate[1], translate[2], 1};
}

/// Mode `time` shows another time step in every frame: every value is scaled by a factor, in whole 256ths, that
/// oscillates with a period of twelve frames.
void step_in_time(int frame, std::vector<double>& values) {
  const int share = static_cast<int>(std::lround(256 * (0.8 + 0.2 * std::cos(2 * M_PI * (frame % 12) / 12))));
  for (double& value : values) {
    const long whole = std::lround(255 * value) * share / 256;
    value = static_cast<double>(whole) / 255.0;
  }
}

/// Mode `stacks` draws one slice per layer of voxels, across the axis nearest to the viewing direction.
void lay_across_axis(const Vec3& direction, bool front_to_back, Volume& volume) {
  int axis = 0;
  for (const int other : {1, 2})
    if (std::abs(direction[other]) > std::abs(direction[axis])) axis = other;
  volume.normal = {};
  volume.normal[axis] = 1;
  volume.offsets.clear();
  const int layers = volume.field.size[axis];
  const bool highest_first = (direction[axis] > 0) != front_to_back;
  for (int i = 0; i < layers; ++i)
    volume.offsets.push_back(((highest_first ? layers - 1 - i : i) + 0.5) / layers);
}

std::vector<Triangle> triangles_of(const Json& solid, const Matrix& clip_from_object) {
  std::vector<Triangle> triangles;
  const auto places = solid.at("positions").get<std::vector<Vec3>>();
  const auto colours = solid.at("colours").get<std::vector<Vec3>>();
  for (std::size_t i = 0; i < colours.size(); ++i) {
    Triangle triangle{{}, colours[i]};
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangle.clip[corner] = project(clip_from_object, places[3 * i + corner]);
    triangles.push_back(triangle);
  }
  return triangles;
}

}  // namespace

Frame viewer_frame(const Json& description) {
  Frame frame;
  const auto viewport = description.at("viewport").get<std::array<int, 4>>();
  frame.width = viewport[2];
  frame.height = viewport[3];
  frame.background = description.at("background").get<Colour>();
  const Json& blend = description.at("blend");
  const std::string equation = blend.at("equation");
  frame.blending.colour = {equation == "GL_MAX"   ? Equation::max
                           : equation == "GL_MIN" ? Equation::min
                                                  : Equation::add,
                           factor_named(blend.at("source")), factor_named(blend.at("destination"))};
  frame.blending.alpha = frame.blending.colour;
  const Json& slices = description.at("slices");
  frame.background_last = slices.at("order") == "front to back";

  const Json& matrices = description.at("matrices");
  const Matrix clip_from_object =
      product(matrices.at("projection").get<Matrix>(), matrices.at("modelview").get<Matrix>());
  const std::string mode = description.at("mode");
  const bool per_voxel = mode == "rgba" || mode == "stacks";
  std::vector<double> values = read_values(description.at("volume"));
  if (mode == "time") step_in_time(description.at("frame"), values);
  for (const Json& placed : description.at("volumes")) {
    Volume volume;
    volume.field.size = description.at("texture").at("size").get<std::array<int, 3>>();
    volume.table.entries = placed.at("entries_rgba8").get<std::vector<Colour>>();
    for (Colour& entry : volume.table.entries)
      for (double& channel : entry) channel /= 255;
    volume.table.bytes = true;
    if (per_voxel) {
      volume.field.components = 4;
      for (const double value : values)
        for (std::size_t channel = 0; channel < 4; ++channel)
          volume.field.texels.push_back(entry_at(volume.table, value, channel));
    } else {
      volume.field.texels = values;
    }
    volume.clip_from_texture = product(clip_from_object, matrix_of(placed.at("object_from_texture")));
    volume.normal = slices.at("normal_texture").get<Vec3>();
    volume.offsets = slices.at("offsets").get<std::vector<double>>();
    if (mode == "stacks")
      lay_across_axis(slices.at("normal_object").get<Vec3>(), frame.background_last, volume);
    frame.volumes.push_back(std::move(volume));
  }
  frame.solid = triangles_of(description.at("solid"), clip_from_object);
  return frame;
}

std::vector<double> emulate(const Json& description) {
  const Rounding none{.clamps = false};
  std::vector<double> image = meant(draw(viewer_frame(description), {}, none, none), 3);
  for (double& channel : image) channel *= 255;
  return image;
}

}  // namespace emulation
