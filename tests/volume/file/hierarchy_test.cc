// SPDX-License-Identifier: Apache-2.0
// Hierarchical volumes: the converted data is read back whole, in parts and level by level, within the allowed
// error and within the errors that the block table states.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>

#include "tests/volume/file/volume_files.h"
#include "volume/file/file_error.h"
#include "volume/file/hierarchical_volume.h"
#include "volume/file/hierarchical_writer.h"
#include "volume/opening/open_volume.h"

namespace understudy::volume::testing {
namespace {

using Size = std::array<int, 3>;

constexpr std::array<ScalarType, 8> held_types{ScalarType::u8,  ScalarType::i8,  ScalarType::u16,
                                               ScalarType::i16, ScalarType::u32, ScalarType::i32,
                                               ScalarType::f32, ScalarType::f64};

std::string raw_name(const Size& size, ScalarType type) {
  return "a_" + std::to_string(size[0]) + "x" + std::to_string(size[1]) + "x" + std::to_string(size[2]) + "_" +
         std::string(name_of(type)) + ".raw";
}

std::string converted(const TemporaryFolder& folder, const Size& size, ScalarType type, const Bytes& scalars,
                      const HierarchyOptions& options = {}, HierarchyFigures* figures = nullptr) {
  const auto raw = open_volume(folder.write(raw_name(size, type), scalars));
  const std::string path = folder.file("a.uvol");
  const HierarchyFigures got = write_hierarchical(*raw, path, options);
  EXPECT_EQ(got.file_bytes, std::filesystem::file_size(path));
  if (figures != nullptr) *figures = got;
  return path;
}

template <typename T>
std::vector<T> smooth_field(const Size& size, double low, double high) {
  std::vector<T> values;
  for (int z = 0; z < size[2]; ++z)
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x) {
        const double wave = std::sin(0.07 * x + 0.4) * std::cos(0.05 * y) * std::sin(0.06 * z + 1);
        values.push_back(T(low + (high - low) * (0.5 + 0.5 * wave)));
      }
  return values;
}

TEST(HierarchicalVolume, HoldsEveryScalarOfEveryTypeAndSize) {
  for (const Size& size :
       {Size{1, 1, 1}, Size{64, 64, 64}, Size{65, 1, 1}, Size{65, 3, 130}, Size{129, 70, 33}})
    for (const ScalarType type : held_types)
      for (const Prediction prediction : {Prediction::linear, Prediction::cubic}) {
        const TemporaryFolder folder;
        const Bytes scalars = random_scalars(size, type, 5 + unsigned(type));
        const auto file =
            open_volume(converted(folder, size, type, scalars, {.prediction = prediction, .effort = 1}));
        ASSERT_EQ(file->description().size, size);
        ASSERT_EQ(file->description().type, type);
        ASSERT_EQ(read_box(*file, whole(*file)), scalars) << name_of(type) << " " << size[0];
      }
}

TEST(HierarchicalVolume, HoldsWhatIsNoNumberToTheLastBit) {
  const Size size{70, 66, 5};
  std::vector<float> values = smooth_field<float>(size, -3, 8);
  values[17] = std::numeric_limits<float>::infinity();
  values[400] = -std::numeric_limits<float>::infinity();
  values[9000] = std::bit_cast<float>(0x7fc12345U);
  values[9001] = std::numeric_limits<float>::denorm_min();
  values[9002] = -0.0F;
  for (const double max_error : {0.0, 1e-3}) {
    const TemporaryFolder folder;
    const auto file =
        open_volume(converted(folder, size, ScalarType::f32, bytes_of(values), {.max_error = max_error}));
    const Bytes read = read_box(*file, whole(*file));
    std::vector<float> got(values.size());
    std::memcpy(got.data(), read.data(), read.size());
    if (max_error == 0) {
      EXPECT_EQ(read, bytes_of(values));
    }
    for (const std::size_t odd : {17U, 400U, 9000U})
      EXPECT_EQ(std::bit_cast<std::uint32_t>(got[odd]), std::bit_cast<std::uint32_t>(values[odd]));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isfinite(values[i])) {
        ASSERT_NEAR(got[i], values[i], max_error);
      }
  }
}

TEST(HierarchicalVolume, GivesBoxesInAnyOrderAndReadsLittleForThem) {
  const Size size{150, 140, 130};
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(size, ScalarType::u16, 2);
  const std::string path = converted(folder, size, ScalarType::u16, scalars, {.effort = 1});
  const auto file = open_hierarchical(path);
  std::mt19937 random(3);
  for (int i = 0; i < 30; ++i) {
    const TexelBox box = random_box(size, random);
    Bytes expected(texels_in(box) * 2);
    copy_texels(box, 2, whole(*file), scalars, box, expected);
    ASSERT_EQ(read_box(*file, box), expected);
  }
  const auto fresh = open_hierarchical(path);
  read_box(*fresh, {{0, 0, 0}, {20, 20, 20}});
  EXPECT_LT(fresh->bytes_read(), std::filesystem::file_size(path) / 4);
}

/// Trilinear interpolation of a level, clamped to its last sample.
double interpolated(const std::vector<float>& level, const Size& size, int step, const Size& at) {
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    Size place{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int low = at[k] / step;
      const double part = double(at[k] % step) / step;
      const bool upper = (corner >> k & 1) != 0;
      weight *= upper ? part : 1 - part;
      place[k] = std::min(low + (upper ? 1 : 0), size[k] - 1);
    }
    sum += weight * double(level[(std::size_t(place[2]) * std::size_t(size[1]) + std::size_t(place[1])) *
                                     std::size_t(size[0]) +
                                 std::size_t(place[0])]);
  }
  return sum;
}

TEST(HierarchicalVolume, LevelsAreWithinTheErrorsThatAreStated) {
  const Size size{150, 131, 90};
  std::vector<float> values = smooth_field<float>(size, 0, 100);
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0, 0.5F);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (i % size_t(size[0]) < 50) values[i] += noise(random);
  for (const double max_error : {0.0, 0.25}) {
    const TemporaryFolder folder;
    HierarchyFigures figures;
    const auto file = open_hierarchical(
        converted(folder, size, ScalarType::f32, bytes_of(values), {.max_error = max_error}, &figures));
    ASSERT_EQ(file->grid().levels(), 3);
    for (int level = 0; level < file->grid().levels(); ++level) {
      const Size extent = file->grid().size(level);
      std::vector<float> samples(texels_in({{0, 0, 0}, extent}));
      file->read_level(level, {{0, 0, 0}, extent}, std::as_writable_bytes(std::span(samples)));
      double largest = 0;
      for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
          for (int x = 0; x < size[0]; ++x) {
            const double own =
                double(values[(std::size_t(z) * std::size_t(size[1]) + std::size_t(y)) * std::size_t(size[0]) +
                              std::size_t(x)]);
            largest = std::max(largest, std::abs(interpolated(samples, extent, 1 << level, {x, y, z}) - own));
          }
      const double stated = figures.levels[std::size_t(level)].error;
      std::printf("max error %g, level %d: off by %g, stated %g\n", max_error, level, largest, stated);
      EXPECT_LE(largest, stated + 1e-5);
      EXPECT_LE(stated, 4 * largest + 1e-5) << "the bound says too little";
      EXPECT_EQ(file->error_of_level(level), stated);
    }
  }
}

/// Between the last sample of a block and the first of the next, the next block's samples contribute as well.
TEST(HierarchicalVolume, ErrorsOfBlocksHoldUpToTheBlocksBehind) {
  const Size size{260, 140, 70};
  std::vector<float> values(texels_in({{0, 0, 0}, size}));
  const auto at = [&](int x, int y, int z) {
    return (std::size_t(z) * std::size_t(size[1]) + std::size_t(y)) * std::size_t(size[0]) + std::size_t(x);
  };
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(0, 0.01F);
  for (float& value : values) value = uniform(random);
  // A peak at sample (64, 1, 1) of level 1, and the slope that level 1 interpolates before it.
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 126; x <= 128; ++x) {
        const auto part = [](int i) { return std::max(0.0F, 1 - std::abs(float(i - 2)) / 2); };
        values[at(x, y, z)] += float(x - 126) / 2 * part(y) * part(z);
      }
  const TemporaryFolder folder;
  const auto file = open_hierarchical(converted(folder, size, ScalarType::f32, bytes_of(values)));
  const LevelGrid& grid = file->grid();
  for (int level = 0; level < grid.coarsest(); ++level) {
    const Size extent = grid.size(level + 1);
    std::vector<float> coarser(texels_in({{0, 0, 0}, extent}));
    file->read_level(level + 1, {{0, 0, 0}, extent}, std::as_writable_bytes(std::span(coarser)));
    for_each_block({{0, 0, 0}, grid.blocks(level)}, [&](const BlockPlace& place) {
      const auto low = [&](std::size_t k) { return (place[k] * hierarchy_block_edge) << level; };
      const auto high = [&](std::size_t k) {
        return std::min(((place[k] + 1) * hierarchy_block_edge) << level, size[k]);
      };
      double largest = 0;
      for (int z = low(2); z < high(2); ++z)
        for (int y = low(1); y < high(1); ++y)
          for (int x = low(0); x < high(0); ++x)
            largest = std::max(largest, std::abs(interpolated(coarser, extent, 2 << level, {x, y, z}) -
                                                 double(values[at(x, y, z)])));
      EXPECT_LE(largest, file->block(grid.number_of(level, place)).coarser_error + 1e-6)
          << "level " << level << ", block " << place[0] << " " << place[1];
    });
  }
}

TEST(HierarchicalVolume, KeepsAnErrorOfIntegersAndGetsSmaller) {
  const Size size{100, 90, 80};
  std::vector<std::int16_t> values = smooth_field<std::int16_t>(size, -1000, 2000);
  std::mt19937 random(8);
  for (std::int16_t& value : values) value = std::int16_t(value + int(random() % 9) - 4);
  values[5] = std::numeric_limits<std::int16_t>::max();
  values[6] = std::numeric_limits<std::int16_t>::min();
  std::uint64_t before = std::numeric_limits<std::uint64_t>::max();
  for (const double max_error : {0.0, 1.0, 4.0, 16.0}) {
    const TemporaryFolder folder;
    HierarchyFigures figures;
    const auto file = open_volume(
        converted(folder, size, ScalarType::i16, bytes_of(values), {.max_error = max_error}, &figures));
    const Bytes read = read_box(*file, whole(*file));
    std::vector<std::int16_t> got(values.size());
    std::memcpy(got.data(), read.data(), read.size());
    int largest = 0;
    for (std::size_t i = 0; i < values.size(); ++i) largest = std::max(largest, std::abs(got[i] - values[i]));
    std::printf("max error %g: off by %d, %.3f of the volume\n", max_error, largest,
                double(figures.file_bytes) / double(figures.scalar_bytes));
    EXPECT_LE(largest, max_error);
    EXPECT_LT(figures.file_bytes, before);
    before = figures.file_bytes;
  }
}

TEST(HierarchicalVolume, KnowsTheRangeOfEveryBlock) {
  const Size size{130, 64, 64};
  std::vector<std::uint8_t> values(texels_in({{0, 0, 0}, size}), 7);
  values[129] = 200;
  const TemporaryFolder folder;
  const auto file = open_hierarchical(converted(folder, size, ScalarType::u8, bytes_of(values)));
  const LevelGrid& grid = file->grid();
  EXPECT_EQ(file->block(grid.number_of(0, {0, 0, 0})).high, 7);
  EXPECT_EQ(file->block(grid.number_of(0, {2, 0, 0})).high, 200);
  EXPECT_EQ(file->block(0).low, 7);
  EXPECT_EQ(file->block(0).high, 200);
}

/// Every change is detected or has no effect.
TEST(HierarchicalVolume, DamageIsFoundOut) {
  const Size size{80, 70, 66};
  const TemporaryFolder folder;
  std::vector<std::uint8_t> values = smooth_field<std::uint8_t>(size, 0, 255);
  const std::string path = converted(folder, size, ScalarType::u8, bytes_of(values));
  std::ifstream in(path, std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  std::mt19937 random(9);
  int refused = 0;
  constexpr int mutants = 1000;
  for (int i = 0; i < mutants; ++i) {
    std::string bad = good;
    if (i % 4 == 0) {
      bad.resize(random() % good.size());
    } else {
      // Half of the changes hit the header and the block table, which are a small part of the file.
      const std::size_t most = i % 2 == 0 ? 600 : good.size();
      bad[random() % most] = char(bad[random() % most] ^ (1U << random() % 8));
    }
    try {
      const auto file = open_volume(folder.write("b_80x70x66.uvol", bad));
      ASSERT_EQ(read_box(*file, whole(*file)), bytes_of(values)) << "mutant " << i;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("b_80x70x66.uvol"), std::string::npos);
      ++refused;
    }
  }
  std::printf("%d of %d mutants refused\n", refused, mutants);
  EXPECT_GT(refused, mutants * 9 / 10);
}

/// Makes the checksum valid again, as the author of a malicious file would.
void renew_checksum(std::string& file, std::size_t from, std::size_t bytes) {
  const auto sum = std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(file.data() + from), uInt(bytes)));
  for (std::size_t i = 0; i < sizeof sum; ++i) file[from + bytes + i] = char(sum >> (8 * i) & 0xff);
}

TEST(HierarchicalVolume, WhatHasItsChecksumRenewedIsRefusedOrReadWithinItsMemory) {
  const Size size{80, 70, 66};
  const TemporaryFolder folder;
  const std::string path = converted(folder, size, ScalarType::u16, random_scalars(size, ScalarType::u16, 3),
                                     {.max_error = 4, .effort = 1});
  std::ifstream in(path, std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  const std::size_t table = std::size_t(blocks_begin(LevelGrid(size))) - hierarchical_header_bytes;
  constexpr std::size_t sum = sizeof(std::uint32_t);
  std::mt19937 random(10);
  int refused = 0;
  constexpr int mutants = 1000;
  for (int i = 0; i < mutants; ++i) {
    std::string bad = good;
    const bool header = i % 2 == 0;
    const std::size_t from = header ? 0 : hierarchical_header_bytes;
    const std::size_t bytes = (header ? hierarchical_header_bytes : table) - sum;
    // One byte, or the eight bytes of a number.
    const std::size_t at = from + random() % bytes;
    const std::size_t count = i % 3 == 0 ? std::min<std::size_t>(8, from + bytes - at) : 1;
    for (std::size_t k = 0; k < count; ++k) bad[at + k] = char(random());
    renew_checksum(bad, from, bytes);
    try {
      const auto file = open_volume(folder.write("c_80x70x66.uvol", bad));
      // The header may claim the size of a much larger volume, so only a part is read.
      TexelBox part = whole(*file);
      for (int& n : part.high) n = std::min(n, 100);
      read_box(*file, part);
      file->values_in(part);
      file->memory_to_read(part);
    } catch (const FileError&) {
      ++refused;
    }
  }
  std::printf("%d of %d mutants refused\n", refused, mutants);
  EXPECT_GT(refused, mutants / 4);
}

TEST(HierarchicalVolume, TellsBetweenWhichValuesABoxLies) {
  const Size size{150, 131, 90};
  const std::vector<float> values = smooth_field<float>(size, -3, 100);
  const TemporaryFolder folder;
  for (const double max_error : {0.0, 0.5}) {
    const std::string path =
        converted(folder, size, ScalarType::f32, bytes_of(values), {.max_error = max_error});
    std::mt19937 random(4);
    for (const int level : {0, 1, 2}) {
      const auto file = open_volume(path, {.level = level});
      ASSERT_TRUE(file->description().values);
      EXPECT_EQ((*file->description().values)[0], double(*std::ranges::min_element(values)));
      EXPECT_EQ((*file->description().values)[1], double(*std::ranges::max_element(values)));
      for (int i = 0; i < 20; ++i) {
        const TexelBox box = random_box(file->description().size, random);
        const Bytes read = read_box(*file, box);
        std::vector<float> got(read.size() / sizeof(float));
        std::memcpy(got.data(), read.data(), read.size());
        const auto told = file->values_in(box);
        ASSERT_TRUE(told);
        EXPECT_LE((*told)[0], double(*std::ranges::min_element(got)) + 1e-6);
        EXPECT_GE((*told)[1], double(*std::ranges::max_element(got)) - 1e-6);
      }
    }
  }
}

TEST(HierarchicalVolume, InfiniteScalarsBoundTheirBoxesButNotTheRangeOfTheVolume) {
  const Size size{150, 70, 40};
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const float extreme : {infinity, -infinity}) {
    std::vector<float> values = smooth_field<float>(size, -3, 100);
    values[149] = extreme;  // an odd sample: of the finest level alone
    const TemporaryFolder folder;
    const std::string path = converted(folder, size, ScalarType::f32, bytes_of(values));
    for (const int level : {0, 1}) {
      const auto file = open_volume(path, {.level = level});
      EXPECT_FALSE(file->description().values) << level;
      const auto told = file->values_in(whole(*file));
      ASSERT_TRUE(told);
      EXPECT_EQ((*told)[extreme > 0 ? 1 : 0], double(extreme));
      const auto elsewhere = file->values_in({{0, 0, 0}, {64 >> level, 64 >> level, 40 >> level}});
      ASSERT_TRUE(elsewhere);
      EXPECT_TRUE(std::isfinite((*elsewhere)[0]) && std::isfinite((*elsewhere)[1])) << level;
    }
  }
}

TEST(HierarchicalVolume, OfAnotherVersionIsRefusedByName) {
  const Size size{8, 8, 8};
  const TemporaryFolder folder;
  const std::string path = converted(folder, size, ScalarType::u8, random_scalars(size, ScalarType::u8, 1));
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(8);
  file.put(2);
  file.close();
  try {
    open_volume(path);
    FAIL() << "was read";
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("version 2"), std::string::npos) << error.what();
  }
}

TEST(HierarchicalVolume, IsNotLeftBehindWhereTheDiskIsFull) {
  const Size size{100, 100, 100};
  const TemporaryFolder folder;
  const auto raw =
      open_volume(folder.write(raw_name(size, ScalarType::u8), random_scalars(size, ScalarType::u8, 4)));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{100000, before.rlim_max};
  const auto former = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(write_hierarchical(*raw, folder.file("full.uvol"), {}), FileError);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, former);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.file("")), {}), 1) << "something was left";
}

TEST(HierarchicalVolume, ReplacesNoDeviceAndNoLink) {
  const Size size{4, 4, 4};
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(size, ScalarType::u8, 4);
  const auto raw = open_volume(folder.write(raw_name(size, ScalarType::u8), scalars));
  EXPECT_THROW(write_hierarchical(*raw, "/dev/null", {}), FileError);
  folder.write("real.uvol", std::string("old"));
  std::filesystem::create_symlink(folder.file("real.uvol"), folder.file("link.uvol"));
  write_hierarchical(*raw, folder.file("link.uvol"), {});
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.uvol")));
  const auto file = open_volume(folder.file("real.uvol"));
  EXPECT_EQ(read_box(*file, whole(*file)), scalars);
}

TEST(HierarchicalVolume, RefusesTypesThatItCannotHold) {
  const Size size{4, 4, 4};
  const TemporaryFolder folder;
  const auto raw =
      open_volume(folder.write(raw_name(size, ScalarType::u64), random_scalars(size, ScalarType::u64, 4)));
  EXPECT_THROW(write_hierarchical(*raw, folder.file("a.uvol"), {}), FileError);
}

}  // namespace
}  // namespace understudy::volume::testing
