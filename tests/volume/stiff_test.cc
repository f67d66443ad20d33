// SPDX-License-Identifier: Apache-2.0
// Hard cases on the CPU, against the same samples in double precision.
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/volume/stiff_cases.h"

namespace understudy::volume::testing {

void PrintTo(const StiffCase& one, std::ostream* out) {
  *out << one.name;
}

namespace {

class Stiff : public ::testing::TestWithParam<StiffCase> {};

TEST_P(Stiff, StaysWithinItsBound) {
  expect_within_bounds(GetParam(), "CPU", raycast);
}

std::string name_of(const ::testing::TestParamInfo<StiffCase>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Tables, Stiff, ::testing::ValuesIn(stiff_tables()), name_of);
INSTANTIATE_TEST_SUITE_P(Fields, Stiff, ::testing::ValuesIn(stiff_fields()), name_of);
INSTANTIATE_TEST_SUITE_P(Views, Stiff, ::testing::ValuesIn(stiff_views()), name_of);

TEST(StiffViews, ASingularMatrixIsRefused) {
  StiffCase one = stiff_fields().front();
  for (std::size_t column = 0; column < 4; ++column)
    one.request.texture_to_clip[column] = one.request.texture_to_clip[4 + column];
  EXPECT_THROW(render_whole(one.texture, one.request), std::invalid_argument);
}

}  // namespace
}  // namespace understudy::volume::testing
