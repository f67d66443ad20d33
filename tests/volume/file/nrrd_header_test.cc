// SPDX-License-Identifier: Apache-2.0
// NRRD headers that are written beside texels: read by teem's library, and by the readers here.
#include "volume/file/nrrd_header.h"

#include <gtest/gtest.h>
#include <teem/nrrd.h>

#include <cstring>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "tests/apps/viewer/temporary_folder.h"
#include "volume/opening/open_volume.h"

namespace understudy::volume {
namespace {

constexpr std::array<int, 3> size{5, 4, 3};

struct Stored {
  TexelType type;
  int nrrd;
};

class NrrdHeader : public ::testing::TestWithParam<Stored> {
 protected:
  /// Writes texels whose bytes count up, and returns the header's path.
  std::string write() {
    bytes.resize(std::size_t(size[0] * size[1] * size[2]) * bytes_per_texel(GetParam().type));
    std::iota(reinterpret_cast<unsigned char*>(bytes.data()),
              reinterpret_cast<unsigned char*>(bytes.data() + bytes.size()), static_cast<unsigned char>(0));
    folder.write("volume.raw", bytes);
    return folder.write("volume.nhdr", nrrd_header(size, GetParam().type, "volume.raw"));
  }

  viewer_test::TemporaryFolder folder;
  std::vector<std::byte> bytes;
};

TEST_P(NrrdHeader, IsReadByTeem) {
  const std::string path = write();
  const std::unique_ptr<Nrrd, Nrrd* (*)(Nrrd*)> nrrd(nrrdNew(), nrrdNuke);
  ASSERT_EQ(nrrdLoad(nrrd.get(), path.c_str(), nullptr), 0) << biffGetDone(NRRD);
  EXPECT_EQ(nrrd->type, GetParam().nrrd);
  const unsigned first = GetParam().type == TexelType::rgba8 ? 1 : 0;
  ASSERT_EQ(nrrd->dim, 3 + first);
  for (unsigned k = 0; k < 3; ++k) EXPECT_EQ(nrrd->axis[k + first].size, std::size_t(size[k]));
  EXPECT_EQ(nrrd->axis[0].size, first == 1 ? 4U : std::size_t(size[0]));
  ASSERT_EQ(nrrdElementNumber(nrrd.get()) * nrrdElementSize(nrrd.get()), bytes.size());
  EXPECT_EQ(std::memcmp(nrrd->data, bytes.data(), bytes.size()), 0);
}

class NrrdHeaderOfScalars : public NrrdHeader {};

TEST_P(NrrdHeaderOfScalars, IsReadAsAVolumeToRender) {
  const auto volume = open_volume(write(), {});
  EXPECT_EQ(volume->description().size, size);
  EXPECT_EQ(bytes_per_scalar(volume->description().type), bytes_per_texel(GetParam().type));
}

constexpr Stored bytes_of_colours{TexelType::rgba8, nrrdTypeUChar};
const auto scalars =
    ::testing::Values(Stored{TexelType::u8, nrrdTypeUChar}, Stored{TexelType::u16, nrrdTypeUShort},
                      Stored{TexelType::f32, nrrdTypeFloat});

INSTANTIATE_TEST_SUITE_P(Scalars, NrrdHeader, scalars);
INSTANTIATE_TEST_SUITE_P(Colours, NrrdHeader, ::testing::Values(bytes_of_colours));
INSTANTIATE_TEST_SUITE_P(, NrrdHeaderOfScalars, scalars);

}  // namespace
}  // namespace understudy::volume
