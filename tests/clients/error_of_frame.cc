// SPDX-License-Identifier: Apache-2.0
// error_of_frame DESCRIPTION.json FRAME.pfm VOLUME [EVERY]: prints, as JSON, the error of a saved float frame
// against the exact volume rendering integral. The integral is computed in double precision from the viewer's
// description (camera, slices and transfer function) and the volume file alone, independently of what drew the
// frame. Compares every EVERY-th pixel in x and y.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>

#include "apps/understudy/images/image.h"
#include "volume/matrix.h"
#include "volume/opening/open_volume.h"
#include "volume/reference/pixel_integral.h"
#include "volume/request.h"

namespace {

using namespace understudy::volume;
using Json = nlohmann::json;

/// OpenGL matrices are column-major.
Matrix4 matrix_of(const Json& columns) {
  const auto c = columns.get<std::array<double, 16>>();
  Matrix4 m{};
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column) m[4 * row + column] = c[4 * column + row];
  return m;
}

Matrix4 placed(const Json& object_from_texture) {
  const auto scale = object_from_texture.at("scale").get<Vec3>();
  const auto translate = object_from_texture.at("translate").get<Vec3>();
  return {scale[0], 0, 0, translate[0], 0, scale[1], 0, translate[1], 0, 0, scale[2], translate[2], 0, 0, 0, 1};
}

/// The viewer's texels of the file: bytes unchanged, other types as 16-bit values from the smallest to the
/// largest value of the file.
std::vector<std::byte> texels_of(const Json& volume, const std::string& path, VolumeDescription& description) {
  const auto file = open_volume(path);
  description.size = file->description().size;
  description.stored = {{0, 0, 0}, description.size};
  const std::size_t count =
      std::size_t(description.size[0]) * std::size_t(description.size[1]) * std::size_t(description.size[2]);
  const bool bytes = volume.at("type") == "u8";
  std::vector<std::byte> scalars(count * (bytes ? 1 : 2));
  file->read(description.stored, scalars);
  description.type = bytes ? TexelType::u8 : TexelType::u16;
  if (bytes) return scalars;
  const double low = volume.at("value_at_0"), high = volume.at("value_at_1");
  for (std::size_t i = 0; i < count; ++i) {
    std::int16_t value = 0;
    std::memcpy(&value, scalars.data() + 2 * i, 2);
    const auto word = std::uint16_t(std::lround((value - low) / (high - low) * 65535));
    std::memcpy(scalars.data() + 2 * i, &word, 2);
  }
  return scalars;
}

/// The viewer's slices as steps: a table entry is the opacity of the layer from one slice to the next.
RenderRequest request_of(const Json& description) {
  RenderRequest request;
  const Json& matrices = description.at("matrices");
  const Json& placing = description.at("volumes").at(0);
  request.texture_to_clip =
      multiply(multiply(matrix_of(matrices.at("projection")), matrix_of(matrices.at("modelview"))),
               placed(placing.at("object_from_texture")));
  const auto viewport = description.at("viewport").get<std::array<int, 4>>();
  request.viewport = request.window = {viewport[0], viewport[1], viewport[2], viewport[3]};
  const auto offsets = description.at("slices").at("offsets").get<std::vector<double>>();
  const auto normal = description.at("slices").at("normal_texture").get<Vec3>();
  const double spacing = (offsets.back() - offsets.front()) / double(offsets.size() - 1);
  request.steps.emplace();
  for (std::size_t k = 0; k < 3; ++k) request.steps->metric[k] = normal[k] / spacing;
  TransferFunction table;
  for (const auto& entry : placing.at("entries_rgba8").get<std::vector<std::array<double, 4>>>()) {
    const double alpha = entry[3] / 255;
    table.entries.push_back({float(entry[0] / 255 * alpha), float(entry[1] / 255 * alpha),
                             float(entry[2] / 255 * alpha), float(alpha)});
  }
  request.classification = table;
  return request;
}

Json compared(const std::string& described, const std::string& frame, const std::string& volume, int every) {
  const Json description = Json::parse(std::ifstream(described));
  VolumeDescription texture;
  const std::vector<std::byte> texels = texels_of(description.at("volume"), volume, texture);
  const Field field = texture_field(texture, Filter::linear, texels);
  const RenderRequest request = request_of(description);
  const Medium medium = Medium::of_samples(std::get<TransferFunction>(request.classification), 1);
  const understudy::launcher::RgbaImage image = understudy::launcher::read_image(frame);
  if (!image.has_alpha) throw std::runtime_error(frame + " has no alpha beside it");
  std::mutex mutex;
  double greatest = 0, sum = 0, brightest = 0;
  int pixels = 0;
  tbb::parallel_for(0, (image.height + every - 1) / every, [&](int row) {
    const int y = row * every;
    for (int x = 0; x < image.width; x += every) {
      const auto exact = pixel_integral(field, texture.size, request, medium, x, y);
      const float* const shown = image.pixel(x, image.height - 1 - y);
      const std::scoped_lock lock(mutex);
      ++pixels;
      brightest = std::max(brightest, exact[3]);
      for (std::size_t k = 0; k < 4; ++k) {
        const double difference = std::abs(exact[k] - double(shown[k]));
        greatest = std::max(greatest, difference);
        sum += difference * difference;
      }
    }
  });
  return {
      {"max", greatest}, {"rms", std::sqrt(sum / (4.0 * pixels))}, {"pixels", pixels}, {"opacity", brightest}};
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 4) {
    std::fputs("usage: error_of_frame DESCRIPTION.json FRAME.pfm VOLUME [EVERY]\n", stderr);
    return 2;
  }
  try {
    const int every = count > 4 ? std::max(1, std::atoi(arguments[4])) : 1;
    fmt::print("{}\n", compared(arguments[1], arguments[2], arguments[3], every).dump());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error_of_frame: %s\n", error.what());
    return 1;
  }
}
