// SPDX-License-Identifier: Apache-2.0
#include "volume/file/synthetic.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <string_view>
#include <vector>

#include "volume/file/file_error.h"
#include "volume/texel_box.h"

namespace understudy::volume {

namespace {

constexpr std::string_view prefix = "synthetic:";
constexpr float pi = std::numbers::pi_v<float>;

enum class Kind { shells, lobes, gyroid };

/// Evaluates a function of one coordinate at the texel centres `low` to `high` of `size`.
std::vector<float> along(int low, int high, int size, const std::function<float(float)>& function) {
  std::vector<float> values;
  values.reserve(std::size_t(high - low));
  for (int i = low; i < high; ++i) values.push_back(function((float(i) + 0.5F) / float(size)));
  return values;
}

/// Values from 0 to 1, one row of texels at a time. Terms that are common to a row, or that depend on one axis
/// only, are computed once.
class Field {
 public:
  Field(Kind kind, const TexelBox& box, const std::array<int, 3>& size) : kind_(kind), box_(box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto table = [&](const std::function<float(float)>& function) {
        return along(box.low[axis], box.high[axis], size[axis], function);
      };
      if (kind == Kind::gyroid) {
        first_[axis] = table([](float t) { return std::sin(16 * pi * t); });
        second_[axis] = table([](float t) { return std::cos(16 * pi * t); });
      } else {
        first_[axis] = table([](float t) { return (2 * t - 1) * (2 * t - 1); });
        second_[axis] = table([](float t) { return std::sin(pi * (2 * t - 1) / 2); });
      }
    }
    if (kind == Kind::lobes) {
      const std::size_t columns = first_[0].size();
      plane_.resize(columns * first_[1].size());
      for (std::size_t i = 0; i < plane_.size(); ++i)
        plane_[i] =
            std::cos(12 * pi * std::cos(pi / 2 * std::sqrt(first_[0][i % columns] + first_[1][i / columns])));
    }
  }

  void row(int y, int z, std::span<float> to) const {
    const auto iy = std::size_t(y - box_.low[1]), iz = std::size_t(z - box_.low[2]);
    const float fy = first_[1][iy], fz = first_[2][iz], sy = second_[1][iy], sz = second_[2][iz];
    switch (kind_) {
      case Kind::shells:
        for (std::size_t x = 0; x < to.size(); ++x) {
          // A shell at each of four radii, with values increasing outwards, and zero between them.
          const float radius = std::sqrt(first_[0][x] + fy + fz);
          const float shell = std::round(radius * 5);
          const float off = std::abs(radius * 5 - shell) * 8;
          to[x] = shell >= 1 && shell <= 4 ? std::max(0.0F, 1 - off * off) * shell / 4 : 0.0F;
        }
        break;
      case Kind::lobes: {
        constexpr float alpha = 0.25F;
        const float* plane = plane_.data() + iy * to.size();
        for (std::size_t x = 0; x < to.size(); ++x)
          to[x] = (1 - sz + alpha * (1 + plane[x])) / (2 * (1 + alpha));
        break;
      }
      case Kind::gyroid:
        for (std::size_t x = 0; x < to.size(); ++x) {
          const float sum = first_[0][x] * sy + fy * sz + fz * second_[0][x];
          to[x] = 0.5F + sum / 3;
        }
        break;
    }
  }

 private:
  Kind kind_;
  TexelBox box_;
  std::array<std::vector<float>, 3> first_, second_;
  std::vector<float> plane_;  // of lobes: the terms that depend on both x and y
};

template <typename Texel>
void store(std::span<const float> values, float top, std::byte* to) {
  for (const float value : values) {
    constexpr float to_nearest = 0.5F;
    const auto texel = Texel(std::clamp(value, 0.0F, 1.0F) * top + to_nearest);
    std::memcpy(to, &texel, sizeof texel);
    to += sizeof texel;
  }
}

class SyntheticVolume : public VolumeFile {
 public:
  SyntheticVolume(const FileDescription& description, Kind kind) : VolumeFile(description), kind_(kind) {}

  void read(const TexelBox& box, std::span<std::byte> scalars) override {
    const ScalarType type = description().type;
    const std::size_t scalar = bytes_per_scalar(type);
    if (!contains({{0, 0, 0}, description().size}, box) || scalars.size() != texels_in(box) * scalar)
      throw FileError("a part of a synthetic volume was asked for that it does not have");
    const Field field(kind_, box, description().size);
    const auto columns = std::size_t(box.high[0] - box.low[0]), rows = std::size_t(box.high[1] - box.low[1]);
    tbb::parallel_for(box.low[2], box.high[2], [&](int z) {
      std::vector<float> values(columns);
      for (std::size_t y = 0; y < rows; ++y) {
        field.row(box.low[1] + int(y), z, values);
        std::byte* to = scalars.data() + (std::size_t(z - box.low[2]) * rows + y) * columns * scalar;
        if (type == ScalarType::u8)
          store<std::uint8_t>(values, 255, to);
        else if (type == ScalarType::u16)
          store<std::uint16_t>(values, 65535, to);
        else
          std::memcpy(to, values.data(), columns * scalar);
      }
    });
  }

  std::uint64_t bytes_read() const override { return 0; }

 private:
  Kind kind_;
};

}  // namespace

bool is_synthetic(const std::string& name) {
  return name.starts_with(prefix);
}

std::unique_ptr<VolumeFile> open_synthetic(const std::string& name) {
  const auto fail = [&](const std::string& what) {
    throw FileError(fmt::format(
        "{}: {}; write synthetic:XxYxZ:TYPE:KIND, as in synthetic:512x512x512:u8:shells", name, what));
  };
  std::vector<std::string> words{""};
  for (const char c : name.substr(prefix.size())) {
    if (c == ':')
      words.emplace_back();
    else
      words.back() += c;
  }
  if (words.size() > 3) fail("too many parts");

  FileDescription description;
  std::array<std::int64_t, 3> size{};
  const char* at = words[0].data();
  const char* const end = at + words[0].size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis > 0 && (at == end || *at++ != 'x')) fail("the size is not three numbers");
    const auto [stop, error] = std::from_chars(at, end, size[axis]);
    if (error != std::errc()) fail("the size is not three numbers");
    at = stop;
  }
  if (at != end) fail("the size is not three numbers");
  if (words.size() > 1) {
    const std::optional<ScalarType> type = scalar_type_named(words[1]);
    if (type != ScalarType::u8 && type != ScalarType::u16 && type != ScalarType::f32)
      fail(fmt::format("the type '{}' is none of u8, u16 and f32", words[1]));
    description.type = *type;
  }
  Kind kind = Kind::shells;
  if (words.size() > 2) {
    if (words[2] == "lobes")
      kind = Kind::lobes;
    else if (words[2] == "gyroid")
      kind = Kind::gyroid;
    else if (words[2] != "shells")
      fail(fmt::format("the kind '{}' is none of shells, lobes and gyroid", words[2]));
  }
  checked_bytes(size, description.type, name);
  for (std::size_t axis = 0; axis < 3; ++axis) description.size[axis] = int(size[axis]);
  return std::make_unique<SyntheticVolume>(description, kind);
}

}  // namespace understudy::volume
