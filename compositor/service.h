// The render service as its client sees it: volumes go down, pictures come up. Two services keep this contract:
// the embedded one renders in this process, the linked one talks to a group of MPI nodes.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "volume/request.h"

namespace understudy::compositor {

/// The service cannot answer (node lost, socket closed, time out). The caller draws by itself; the message says
/// what happened, where, and what happens next, in one line without a full stop.
class ServiceLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The service understood the request and refuses it (unknown volume, singular matrix, over a limit). Asking
/// again does not help; the message names the reason.
class RequestRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Rendered {
  volume::ImageView image;  ///< over its footprint only; valid until the next call on the service
  volume::FrameCounts counts;
};

class RenderService {
 public:
  virtual ~RenderService() = default;

  /// Announces a volume; texels follow slab by slab. An id that exists is replaced.
  virtual void begin_volume(const volume::VolumeDescription& volume) = 0;
  /// Texels of the slices [first_slice, first_slice + slices) of `stored` (absolute z), tightly packed, x
  /// fastest, native byte order, bytes_per_texel each.
  virtual void add_slices(volume::VolumeId id, int first_slice, int slices,
                          std::span<const std::byte> texels) = 0;
  virtual void end_volume(volume::VolumeId id) = 0;
  virtual void forget_volume(volume::VolumeId id) = 0;

  virtual Rendered render(const volume::RenderRequest& request) = 0;

  /// How many ranks render; 0 for the embedded service.
  virtual int nodes() const = 0;
};

/// Renders in this process, on all cores.
std::unique_ptr<RenderService> embedded_service();

/// Connects to the launcher's Unix socket at `address` and is handed to rank 0 of the node group behind it.
/// Waits at most `patience_ms` for the group. Throws ServiceLost.
std::unique_ptr<RenderService> linked_service(const std::string& address, int patience_ms);

}  // namespace understudy::compositor
