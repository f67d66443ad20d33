// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/icet_compositor.h"

#include <IceT.h>
#include <IceTMPI.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

namespace understudy::bench {

namespace {

struct Strategy {
  const char* name;
  IceTEnum strategy;
  IceTEnum single_image;
  bool interlaced;
};

constexpr std::array known_strategies{
    Strategy{"direct", ICET_STRATEGY_DIRECT, ICET_SINGLE_IMAGE_STRATEGY_AUTOMATIC, true},
    Strategy{"reduce", ICET_STRATEGY_REDUCE, ICET_SINGLE_IMAGE_STRATEGY_AUTOMATIC, true},
    Strategy{"automatic", ICET_STRATEGY_SEQUENTIAL, ICET_SINGLE_IMAGE_STRATEGY_AUTOMATIC, true},
    Strategy{"tree", ICET_STRATEGY_SEQUENTIAL, ICET_SINGLE_IMAGE_STRATEGY_TREE, true},
    Strategy{"bswap", ICET_STRATEGY_SEQUENTIAL, ICET_SINGLE_IMAGE_STRATEGY_BSWAP, true},
    Strategy{"bswap, not interlaced", ICET_STRATEGY_SEQUENTIAL, ICET_SINGLE_IMAGE_STRATEGY_BSWAP, false},
    Strategy{"radixk", ICET_STRATEGY_SEQUENTIAL, ICET_SINGLE_IMAGE_STRATEGY_RADIXK, true},
    Strategy{"radixk, not interlaced", ICET_STRATEGY_SEQUENTIAL, ICET_SINGLE_IMAGE_STRATEGY_RADIXK, false},
};

}  // namespace

struct IcetCompositor::Context {
  IceTCommunicator communicator = icetCreateMPICommunicator(MPI_COMM_WORLD);
  IceTContext context = icetCreateContext(communicator);
};

IcetCompositor::IcetCompositor() : context_(std::make_unique<Context>()) {
  icetDiagnostics(ICET_DIAG_ERRORS);
  icetSetColorFormat(ICET_IMAGE_COLOR_RGBA_FLOAT);
  icetSetDepthFormat(ICET_IMAGE_DEPTH_NONE);
  icetCompositeMode(ICET_COMPOSITE_MODE_BLEND);
  icetEnable(ICET_ORDERED_COMPOSITE);
  icetDisable(ICET_CORRECT_COLORED_BACKGROUND);
}

IcetCompositor::~IcetCompositor() {
  icetDestroyContext(context_->context);
  icetDestroyMPICommunicator(context_->communicator);
}

std::vector<std::string> IcetCompositor::strategies() {
  std::vector<std::string> names;
  for (const Strategy& strategy : known_strategies) names.emplace_back(strategy.name);
  return names;
}

void IcetCompositor::begin(int pixels, std::span<const int> order) {
  icetResetTiles();
  icetAddTile(0, 0, pixels, pixels, 0);
  icetPhysicalRenderSize(pixels, pixels);
  icetCompositeOrder(order.data());
  image_ = volume::Image({0, 0, pixels, pixels});
}

void IcetCompositor::lay_in(const volume::Image& image) {
  valid_ = image.rect;
  for (int y = valid_.y; y < valid_.y + valid_.height; ++y)
    std::memcpy(image_.at(valid_.x, y), image.at(valid_.x, y), 4 * sizeof(float) * std::size_t(valid_.width));
}

volume::ImageView IcetCompositor::compose(const std::string& name) {
  const auto* const chosen = std::ranges::find(known_strategies, name, &Strategy::name);
  if (chosen == known_strategies.end()) throw std::invalid_argument("IceT has no strategy " + name);
  icetStrategy(chosen->strategy);
  icetSingleImageStrategy(chosen->single_image);
  (chosen->interlaced ? icetEnable : icetDisable)(ICET_INTERLACE_IMAGES);
  const std::array<IceTInt, 4> valid{valid_.x, valid_.y, valid_.width, valid_.height};
  const std::array<IceTFloat, 4> black{};
  const IceTImage result =
      icetCompositeImage(image_.rgba.data(), nullptr, valid.data(), nullptr, nullptr, black.data());
  if (const IceTEnum error = icetGetError(); error != ICET_NO_ERROR)
    throw std::runtime_error("IceT failed with error " + std::to_string(error));
  IceTInt rank = 0;
  icetGetIntegerv(ICET_RANK, &rank);
  if (rank != 0) return {};
  return {image_.rect, {icetImageGetColorcf(result), image_.rgba.size()}};
}

std::size_t IcetCompositor::bytes_sent() {
  IceTInt bytes = 0;
  icetGetIntegerv(ICET_BYTES_SENT, &bytes);
  return std::size_t(bytes);
}

}  // namespace understudy::bench
