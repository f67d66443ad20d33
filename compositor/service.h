// SPDX-License-Identifier: Apache-2.0
// The render service as its client sees it: volumes go down, images come up. Two services keep this contract:
// the embedded one renders in this process, the linked one talks to a group of MPI nodes.
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

/// The service cannot answer (node lost, socket closed, time out). The caller draws by itself; the message says
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

/// The service understood the request and refuses it (unknown volume, singular matrix, over a limit). Asking
/// again does not help; the message names the reason.
class RequestRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Rendered;  // rendered.h

/// Images of volumes that are there. All functions but nodes() may throw ServiceLost and RequestRefused.
/// Requests are answered one after the other; not for two threads at once.
class ImageService {
 public:
  virtual ~ImageService() = default;

  /// The image of one request. Its volume must be complete, and have the version that the request names.
  virtual Rendered render(const volume::RenderRequest& request) = 0;

  /// The images of requests with one camera, in their order. What has to be loaded for one is loaded once.
  virtual std::vector<volume::Image> images(std::span<const volume::RenderRequest> requests);
  /// Whether each image loads parts of its volume, so that most of its time is that of loading.
  virtual bool loads_for_images() const { return false; }

  /// What pixels of the request would show if its samples were taken ever more densely
  /// (volume/pixel_integral.h): of as many of `pixels`, in their order, as can be integrated in
  /// `most_ms` on the slowest node. For requests on steps, under `over` with a transfer function and a linear
  /// filter; method, termination, surfaces and light are not looked at.
  virtual std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest& request,
                                                       std::span<const volume::Pixel> pixels,
                                                       double most_ms) = 0;

  /// How many ranks render; 0: this process.
  virtual int nodes() const = 0;
};

class RenderService : public ImageService {
 public:
  // Texels travel while their sender prepares the next: what is wrong with them may be said by a later call, by
  // end_volume() at the latest.

  /// Announces a volume; all its texels follow. An id that exists is replaced.
  virtual void begin_volume(const volume::VolumeDescription& volume) = 0;
  /// A complete volume is about to get another version: the texels that differ follow.
  virtual void begin_change(volume::VolumeId id, std::uint64_t version) = 0;
  /// Texels of boxes inside `stored`, one box after the other, each tightly packed, x fastest, native byte
  /// order, bytes_per_texel each. Between begin_volume() and end_volume() these are slice ranges: each covers
  /// `stored` in x and y, and each slice comes once.
  virtual void add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                          std::span<const std::byte> texels) = 0;
  /// Nothing more follows; the volume is complete.
  virtual void end_volume(volume::VolumeId id) = 0;
  /// Frees its texels on all ranks. An id that is not known is ignored.
  virtual void forget_volume(volume::VolumeId id) = 0;
};

/// Renders in this process, on all cores.
std::unique_ptr<RenderService> embedded_service();

/// Connects to the launcher's Unix socket at `address` and is handed to rank 0 of the node group behind it.
/// Waits at most `patience_ms` for the group. Throws ServiceLost.
std::unique_ptr<RenderService> remote_render_service(const std::string& address, int patience_ms);

}  // namespace understudy::compositor
