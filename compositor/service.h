// SPDX-License-Identifier: Apache-2.0
// The render service as its client sees it: volumes are sent to it, images come back. Two implementations: the
// embedded service renders in this process, the remote one uses a group of MPI nodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "volume/pixel_integral.h"
#include "volume/volume_id.h"

namespace understudy::volume {
struct Image;
struct Pixel;
struct RenderRequest;
struct TexelBox;
struct VolumeDescription;
}  // namespace understudy::volume

namespace understudy::compositor {

/// The service cannot answer (node lost, socket closed, timeout), and the caller draws by itself. what() states
/// what happened, where, and what happens next, in one line without a full stop.
class ServiceLost : public std::runtime_error {
 public:
  explicit ServiceLost(const std::string& what, std::string reason = "the render nodes did not answer")
      : std::runtime_error(what), reason_(std::move(reason)) {}

  /// The same in few words, for the summary.
  const std::string& reason() const { return reason_; }

 private:
  std::string reason_;
};

/// The service understood the request and refuses it (unknown volume, singular matrix, over a limit). Repeating
/// the request does not help; what() gives the reason.
class RequestRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Rendered;  // rendered.h

/// Renders volumes that the service holds. All functions but nodes() may throw ServiceLost and RequestRefused.
/// Requests are answered one after the other; an object must not be used by two threads at once.
class ImageService {
 public:
  virtual ~ImageService() = default;

  /// Renders one image. The volume must be complete and have the version that the request names.
  virtual Rendered render(const volume::RenderRequest& request) = 0;

  /// Renders requests with one camera, in their order. Parts that several of them need are loaded once.
  virtual std::vector<volume::Image> images(std::span<const volume::RenderRequest> requests);
  /// Whether each image loads parts of its volume, so that loading takes most of its time.
  virtual bool loads_for_images() const { return false; }

  /// Returns what pixels of the request would show if its samples were taken ever more densely
  /// (volume/pixel_integral.h): for the first of `pixels`, as many as the slowest node integrates in `most_ms`.
  /// For requests with `steps`, under `over`, with a transfer function, a linear filter and no fog; method,
  /// termination, surfaces and light are ignored.
  virtual std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest& request,
                                                       std::span<const volume::Pixel> pixels,
                                                       double most_ms) = 0;

  /// How many ranks render; 0: this process.
  virtual int nodes() const = 0;
};

class RenderService : public ImageService {
 public:
  // Texels are sent while the sender prepares the next ones: an error in them may be reported by a later call,
  // at the latest by end_volume().

  /// Announces a volume, whose texels follow. A volume with the same id is replaced.
  virtual void begin_volume(const volume::VolumeDescription& volume) = 0;
  /// Begins another version of a complete volume; the texels that differ follow.
  virtual void begin_change(volume::VolumeId id, std::uint64_t version) = 0;
  /// Sends the texels of boxes inside `stored`, one box after the other, each tightly packed, x fastest, native
  /// byte order, bytes_per_texel each. Between begin_volume() and end_volume() the boxes are slice ranges: each
  /// covers `stored` in x and y, and each slice comes once.
  virtual void add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                          std::span<const std::byte> texels) = 0;
  /// Completes the volume: no more texels follow.
  virtual void end_volume(volume::VolumeId id) = 0;
  /// Frees the volume's texels on all ranks. Unknown ids are ignored.
  virtual void forget_volume(volume::VolumeId id) = 0;
};

/// Renders in this process, on all cores.
std::unique_ptr<RenderService> embedded_service();

/// Connects to the launcher's Unix socket at `address`; the launcher passes the connection to rank 0 of its
/// node group. Waits at most `patience_ms` for the group. Throws ServiceLost.
std::unique_ptr<RenderService> remote_render_service(const std::string& address, int patience_ms);

}  // namespace understudy::compositor
