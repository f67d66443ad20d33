// SPDX-License-Identifier: Apache-2.0
// Composites the images of our exchanges with IceT 2.2 (Moreland, Kendall, Peterka, Huang 2011) as in ParaView:
// one tile, premultiplied float RGBA without depth, blended in a given order.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "volume/image.h"

namespace understudy::bench {

class IcetCompositor {
 public:
  /// To be constructed after MPI_Init and destroyed before MPI_Finalize.
  IcetCompositor();
  ~IcetCompositor();
  IcetCompositor(const IcetCompositor&) = delete;
  IcetCompositor& operator=(const IcetCompositor&) = delete;

  /// Returns the strategies that preserve an order; those that divide the image, both
  /// with and without interlacing.
  static std::vector<std::string> strategies();

  /// Sets what is composited from now on: the ranks in `order`, front first, in an
  /// image of `pixels` x `pixels`.
  void begin(int pixels, std::span<const int> order);
  /// Copies this rank's image into an image of full size, as IceT requires it.
  void lay_in(const volume::Image& image);
  /// Collective. Returns the image on rank 0, valid until the next call, and an empty view elsewhere.
  volume::ImageView compose(const std::string& strategy);
  /// Returns the bytes that IceT itself counted in the last call, on this rank.
  static std::size_t bytes_sent();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  volume::Image image_;
  volume::Rect valid_;
};

}  // namespace understudy::bench
