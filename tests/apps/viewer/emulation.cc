#include "tests/apps/viewer/emulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

namespace viewer_test {
namespace {

using Json = nlohmann::json;
using Vec3 = std::array<double, 3>;
using Colour = std::array<double, 4>;
using Mat4 = std::array<double, 16>;  // column-major

Mat4 product(const Mat4& a, const Mat4& b) {
  Mat4 c{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 4; ++k) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return c;
}

// Gauss-Jordan with pivoting.
Mat4 inverse(const Mat4& m) {
  double rows[4][8]{};
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) rows[r][c] = m[4 * c + r];
    rows[r][4 + r] = 1;
  }
  for (int pivot = 0; pivot < 4; ++pivot) {
    int best = pivot;
    for (int r = pivot + 1; r < 4; ++r)
      if (std::abs(rows[r][pivot]) > std::abs(rows[best][pivot])) best = r;
    std::swap(rows[pivot], rows[best]);
    const double divisor = rows[pivot][pivot];
    for (double& x : rows[pivot]) x /= divisor;
    for (int r = 0; r < 4; ++r) {
      if (r == pivot) continue;
      const double factor = rows[r][pivot];
      for (int c = 0; c < 8; ++c) rows[r][c] -= factor * rows[pivot][c];
    }
  }
  Mat4 result;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) result[4 * c + r] = rows[r][4 + c];
  return result;
}

Vec3 project(const Mat4& m, const Vec3& p) {
  std::array<double, 4> h{};
  for (int r = 0; r < 4; ++r) h[r] = m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
  return {h[0] / h[3], h[1] / h[3], h[2] / h[3]};
}

double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The volume file as the description says it is drawn: one value in [0,1] per voxel.
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

Colour mix(const Colour& a, const Colour& b, double t) {
  return {std::lerp(a[0], b[0], t), std::lerp(a[1], b[1], t), std::lerp(a[2], b[2], t),
          std::lerp(a[3], b[3], t)};
}
double mix(double a, double b, double t) {
  return std::lerp(a, b, t);
}

Colour look_up(const std::vector<Colour>& entries, double value) {
  const double position = std::clamp(value, 0.0, 1.0) * 255;
  const auto lower = static_cast<std::size_t>(position);
  const std::size_t upper = std::min<std::size_t>(lower + 1, 255);
  return mix(entries[lower], entries[upper], position - static_cast<double>(lower));
}

// Linear between voxel centres, clamped to the edge; `of_voxel` is what is interpolated.
template <typename OfVoxel>
auto sample(const std::vector<double>& voxels, const std::array<int, 3>& size, const Vec3& t,
            OfVoxel of_voxel) {
  std::array<int, 3> low{}, high{};
  Vec3 weight{};
  for (int axis = 0; axis < 3; ++axis) {
    const double position = t[axis] * size[axis] - 0.5;
    const int floor = static_cast<int>(std::floor(position));
    weight[axis] = position - floor;
    low[axis] = std::clamp(floor, 0, size[axis] - 1);
    high[axis] = std::clamp(floor + 1, 0, size[axis] - 1);
  }
  const auto at = [&](int x, int y, int z) {
    return of_voxel(voxels[(static_cast<std::size_t>(z) * size[1] + y) * size[0] + x]);
  };
  const auto row = [&](int y, int z) { return mix(at(low[0], y, z), at(high[0], y, z), weight[0]); };
  const auto layer = [&](int z) { return mix(row(low[1], z), row(high[1], z), weight[1]); };
  return mix(layer(low[2]), layer(high[2]), weight[2]);
}

}  // namespace

std::vector<double> emulate(const nlohmann::json& description) {
  const auto size = description.at("texture").at("size").get<std::array<int, 3>>();
  const std::vector<double> values = read_values(description.at("volume"));
  auto entries = description.at("classification").at("entries_rgba8").get<std::vector<Colour>>();
  for (Colour& entry : entries)
    for (double& channel : entry) channel /= 255;
  const auto colour_of = [&](double value) { return look_up(entries, value); };
  const auto value_itself = [](double value) { return value; };
  const bool per_voxel = description.at("mode") == "rgba";

  const auto scale = description.at("object_from_texture").at("scale").get<Vec3>();
  const auto translate = description.at("object_from_texture").at("translate").get<Vec3>();
  const Mat4 object_from_texture = {
      scale[0], 0, 0, 0, 0, scale[1], 0, 0, 0, 0, scale[2], 0, translate[0], translate[1], translate[2], 1};
  const Json& matrices = description.at("matrices");
  const Mat4 texture_from_clip =
      inverse(product(product(matrices.at("projection").get<Mat4>(), matrices.at("modelview").get<Mat4>()),
                      object_from_texture));
  const auto normal = description.at("slices").at("normal_texture").get<Vec3>();
  const auto offsets = description.at("slices").at("offsets").get<std::vector<double>>();
  const auto viewport = description.at("viewport").get<std::array<int, 4>>();
  const auto background = description.at("background").get<Colour>();

  std::vector<double> picture;
  for (int y = viewport[3] - 1; y >= 0; --y)
    for (int x = 0; x < viewport[2]; ++x) {
      const double ndc_x = 2 * (x + 0.5) / viewport[2] - 1, ndc_y = 2 * (y + 0.5) / viewport[3] - 1;
      const Vec3 near = project(texture_from_clip, {ndc_x, ndc_y, -1}),
                 far = project(texture_from_clip, {ndc_x, ndc_y, 1});
      const Vec3 along = {far[0] - near[0], far[1] - near[1], far[2] - near[2]};
      Vec3 pixel = {background[0], background[1], background[2]};
      for (const double offset : offsets) {
        const double s = (offset - dot(normal, near)) / dot(normal, along);
        const Vec3 t = {near[0] + s * along[0], near[1] + s * along[1], near[2] + s * along[2]};
        if (std::any_of(t.begin(), t.end(), [](double c) { return c < 0 || c > 1; })) continue;
        const Colour colour =
            per_voxel ? sample(values, size, t, colour_of) : colour_of(sample(values, size, t, value_itself));
        for (int c = 0; c < 3; ++c) pixel[c] = colour[3] * colour[c] + (1 - colour[3]) * pixel[c];
      }
      for (const double channel : pixel) picture.push_back(255 * channel);
    }
  return picture;
}

}  // namespace viewer_test
