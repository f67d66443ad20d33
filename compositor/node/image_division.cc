// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/image_division.h"

#include <algorithm>
#include <exception>
#include <span>

#include "compositor/service/rank_renderer.h"
#include "compositor/sort/cost_image.h"
#include "compositor/sort/image_leaves.h"
#include "volume/request.h"

namespace understudy::compositor {

using volume::Rect;

bool all_agree(Communicator& communicator, bool mine) {
  const auto vote = std::uint8_t(mine);
  std::vector<std::uint8_t> votes(std::size_t(communicator.size()));
  communicator.gather_to_all(std::as_bytes(std::span(&vote, 1)), std::as_writable_bytes(std::span(votes)));
  return std::ranges::count(votes, 0) == 0;
}

std::vector<Rect> divide_image(Communicator& communicator, RankRenderer& renderer, std::uint64_t client,
                               const volume::RenderRequest& request, const Rect& pixels) {
  const Arrangement& arrangement = renderer.arrangement({client, request.volume});
  const auto groups = std::size_t(arrangement.groups());
  const auto mine = std::size_t(arrangement.place(communicator.rank()).group);
  const std::vector<Rect> tiles = tiles_of(pixels);
  // Neighbouring tiles are estimated by different groups, so that no group estimates all expensive tiles.
  std::vector<Rect> own;
  for (std::size_t tile = mine; tile < tiles.size(); tile += groups) own.push_back(tiles[tile]);
  const std::size_t most = (tiles.size() + groups - 1) / groups;
  std::vector<float> told(most), heard(most * std::size_t(communicator.size()));
  try {
    std::ranges::copy(renderer.estimated_costs(client, request, own), told.begin());
  } catch (const std::exception&) {
    std::ranges::fill(told, 0.0F);  // this rank cannot draw either, and will refuse
  }
  communicator.gather_to_all(std::as_bytes(std::span(told)), std::as_writable_bytes(std::span(heard)));
  std::vector<float> costs(tiles.size());
  for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
    for (int member = 0; member < arrangement.members(); ++member) {
      const auto rank = std::size_t(arrangement.rank_at(int(tile % groups), member));
      costs[tile] += heard[rank * most + tile / groups];
    }
  }
  return leaves_of_equal_cost(CostImage(pixels, costs), int(groups));
}

}  // namespace understudy::compositor
