// SPDX-License-Identifier: Apache-2.0
#include "compositor/relay/packing_choice.h"

namespace understudy::compositor {

namespace {

constexpr double weight_of_newest = 0.25;  ///< among the measurements
constexpr int images_between_trials = 200;

}  // namespace

bool PackingChoice::pays(double line_bytes_per_second) {
  if (line_bytes_per_second <= 0) return false;
  const bool faster = seconds_per_byte_ + ratio_ / line_bytes_per_second < 1 / line_bytes_per_second;
  if (!faster && ++unpacked_images_ <= images_between_trials) return false;
  unpacked_images_ = 0;
  return true;
}

void PackingChoice::packed(double seconds, std::size_t bytes, std::size_t packed_bytes) {
  // Unpacking takes about as long.
  seconds_per_byte_ += weight_of_newest * (2 * seconds / double(bytes) - seconds_per_byte_);
  ratio_ += weight_of_newest * (double(packed_bytes) / double(bytes) - ratio_);
}

}  // namespace understudy::compositor
