// SPDX-License-Identifier: Apache-2.0
// Decides whether packing images without loss pays on a connection, by the time that it took before.
#pragma once

#include <cstddef>

namespace understudy::compositor {

class PackingChoice {
 public:
  /// Whether the next image arrives earlier if it is packed; false as long as the connection's speed is not
  /// known (0). True now and then although packing seemed slow: it may have been measured while the machine was
  /// busy, and only packed images correct that.
  bool pays(double line_bytes_per_second);
  /// An image of `bytes` was packed into `packed_bytes`.
  void packed(double seconds, std::size_t bytes, std::size_t packed_bytes);

 private:
  double seconds_per_byte_ = 0.5e-9;  ///< for packing and unpacking
  double ratio_ = 0.5;                ///< of packed bytes to bytes
  int unpacked_images_ = 0;           ///< since one was packed
};

}  // namespace understudy::compositor
