// SPDX-License-Identifier: Apache-2.0
// IceT 2.2 (Moreland, Kendall, Peterka, Huang 2011), as ParaView has it, on the images that our exchanges get:
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
  /// After MPI_Init; ends before MPI_Finalize.
  IcetCompositor();
  ~IcetCompositor();
  IcetCompositor(const IcetCompositor&) = delete;
  IcetCompositor& operator=(const IcetCompositor&) = delete;

  /// Its strategies that keep an order, those that divide the image with and without interlacing it.
  static std::vector<std::string> strategies();

  /// What is composed from now on: `order` front first, in an image of `pixels` x `pixels`.
  void begin(int pixels, std::span<const int> order);
  /// This rank's image, laid into an image of full size, as IceT takes it.
  void lay_in(const volume::Image& image);
  /// Collective. On rank 0 the image, which is there until the next call; else nothing.
  volume::ImageView compose(const std::string& strategy);
  /// That IceT itself counted in the last call, on this rank.
  static std::size_t bytes_sent();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  volume::Image image_;
  volume::Rect valid_;
};

}  // namespace understudy::bench
