// SPDX-License-Identifier: Apache-2.0
// One rank of a node group: rank 0 receives requests of applications (clients.h) and gives orders, the others
// follow; all perform the same requests in the same order. Sources: rank_loop.cc gives orders and replies,
// rank_volumes.cc receives texels, rank_images.cc draws and composites.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compositor/exchange/communicator.h"
#include "compositor/node/clients.h"
#include "compositor/node/compositing.h"
#include "compositor/node/image_buffer.h"
#include "compositor/node/node.h"
#include "compositor/node/opaque_tiles.h"
#include "compositor/node/outcome.h"
#include "compositor/node/overlap.h"
#include "compositor/node/rebalancer.h"
#include "compositor/service/integral_parts.h"
#include "compositor/service/loads.h"
#include "compositor/service/rank_renderer.h"
#include "compositor/service/service_protocols.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {

class RankLoop {
 public:
  RankLoop(Communicator& communicator, const NodeSettings& settings)
      : communicator_(communicator),
        may_divide_images_(settings.sort.sort != Sort::last && communicator.size() > 1),
        renderer_(communicator.rank(), communicator.machines(), settings.make_renderer, settings.limits,
                  settings.sort),
        loads_(renderer_, communicator.rank(), settings.files),
        memories_(communicator, settings.exchange.gather),
        compositing_(communicator, settings.exchange),
        overlap_(settings.exchange.overlap) {
    const bool moves =
        settings.balance.balance != Balance::off || settings.sort.partition == volume::PartitionMethod::cost;
    if (moves && !may_divide_images_ && communicator.size() > 1)
      rebalancer_.emplace(communicator, renderer_, settings.balance, settings.sort.partition);
  }

  bool lead(const std::string& control_path, std::chrono::milliseconds stall_patience);
  void follow();

 private:
  void forget_client(std::uint64_t client);
  void request(Clients& clients, Clients::Request request);
  std::vector<Outcome> texels(const Order& order, std::span<volume::TexelBox> boxes, Bytes here);
  bool make_room(std::uint64_t bytes);
  bool receive_payload(const Order& order, std::span<std::byte> here);
  void receive_shares(VolumeKey key, std::span<const volume::TexelBox> boxes);
  void send_shares(VolumeKey key, std::span<const volume::TexelBox> boxes, Bytes texels);
  std::vector<Outcome> perform(const Order& order, Bytes payload);
  void perform_own_part(const Order& order, Bytes payload, OwnOutcome& mine);
  void take_volume(NodeMessage message, const Order& order, Bytes payload, OwnOutcome& mine);
  void load(LoadMessage message, const Order& order, Bytes payload, OwnOutcome& mine);
  void integrate(const Order& order, Bytes payload);
  void begin_request(const Order& order, Bytes payload, OwnOutcome& mine);
  void reply_to_load(Clients& clients, const Clients::Request& request, const std::vector<Outcome>& outcomes);
  void reply_with_image(Clients& clients, const Clients::Request& request, const Order& order,
                        const std::vector<Outcome>& outcomes, std::chrono::steady_clock::time_point start);
  void after_image(const OwnOutcome& mine, std::vector<Outcome>& outcomes);
  void begin_image(std::uint64_t client);
  void begin_divided_image(std::uint64_t client, const std::function<volume::RenderRequest()>& decode,
                           OwnOutcome& mine);
  void divide_image(std::uint64_t client);
  void draw(OwnOutcome& mine);
  void draw_in_bands(OwnOutcome& mine);
  void clear_hidden(std::vector<Outcome>& outcomes);
  std::vector<Outcome> agree(const OwnOutcome& mine);
  void tell_where_bricks_are(VolumeKey key, OwnOutcome& mine) const;
  void find_bricks(VolumeKey key, const std::vector<Outcome>& outcomes);
  std::optional<volume::Rect> composite(const std::vector<Outcome>& outcomes, volume::FrameCounts& counts);
  std::vector<volume::PixelIntegral> compose_integrals();
  std::vector<std::uint64_t> sum_histograms();

  Communicator& communicator_;
  bool may_divide_images_;  ///< sort-first or hybrid, for some volumes
  RankRenderer renderer_;
  Loads loads_;
  std::optional<Rebalancer> rebalancer_;  // if there is something to balance
  ImageBuffers memories_;
  Compositing compositing_;
  OverlapChoice overlap_;  // rank 0 decides
  /// By application, then by place.
  std::map<std::uint64_t, std::array<volume::PreIntegrationTable, limits::max_kept_pre_integration_tables>>
      pre_integration_tables_;
  std::vector<std::byte> payload_space_;  // of the same size on all ranks but 0
  std::size_t room_ = 0;                  // that size, known to rank 0 too
  Reason reason_{};                       // of the last refusal
  std::vector<volume::TexelBox> shares_;  // this rank's, of the current texels
  // The current render request.
  VolumeKey rendered_;
  volume::RenderRequest request_;
  ImageTask task_;
  std::vector<volume::Rect> footprints_;  // by rank: what it could show at most
  volume::Rect whole_;                    // what all ranks could
  std::optional<volume::Rect> leaf_;      // this group's part of the image, if groups divide it
  volume::FrameCounts travelled_;         // what was sent while the image was drawn
  volume::Image image_;
  std::uint32_t images_ = 0;  // that were requested, this one included
  std::optional<OpaqueTiles> opaque_tiles_;
  // This rank's parts of the current integrals; as many elements as pixels were asked for.
  std::vector<IntegralPart> integrals_;
  std::vector<Rank> integral_order_;
  std::size_t integrated_ = 0;            // how many of them are computed
  std::vector<std::uint64_t> histogram_;  // the current one, of this rank's cells
};

inline bool is_load(const MessageType& type) {
  return type == LoadMessage::load_volume || type == LoadMessage::continue_load;
}

}  // namespace understudy::compositor
