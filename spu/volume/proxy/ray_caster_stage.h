// SPDX-License-Identifier: Apache-2.0
// The stage for ray casters: from the draw of a box whose fragment shader marches, to a request. It replaces
// upload, classification and composition of slices: how rays march determines what colours mean, and is
// measured on the texels' own range of values.
#pragma once

#include <vector>

#include "spu/volume/classification/classifier.h"
#include "spu/volume/proxy/cuts.h"
#include "spu/volume/proxy/known_march.h"
#include "spu/volume/proxy/probe_surfaces.h"
#include "spu/volume/request/image_request.h"
#include "spu/volume/request/request_composer.h"
#include "spu/volume/upload/uploader.h"
#include "spu/volume/verification/native_image.h"
#include "spu/volume/verification/verified_volume.h"
#include "volume/frame_counts.h"

namespace understudy::compositor {
class RenderService;
}

namespace understudy::spu {

/// What is stored about the volume that a ray caster draws.
struct KnownRayCaster {
  KnownMarch& march;
  SentVolume& sent;
  const VerifiedVolume& verified;
  const RefusalHistory& refusals;
  std::uint64_t& frames;  ///< in which it was substituted; 0 again once its march is measured anew
  VolumeCounters& counters;
};

/// The image that is requested, and its camera.
struct RayCasterRequest {
  ImageRequest image;
  CameraFit camera;
};

class RayCasterStage {
 public:
  RayCasterStage(const GlContext& context, ShareGroup& group, RenderSession& session, ProgramReader& programs,
                 Uploader& uploader, Classifier& classifier, RequestComposer& composer, FrameAccount& account)
      : context_(context),
        group_(group),
        session_(session),
        programs_(programs),
        uploader_(uploader),
        classifier_(classifier),
        composer_(composer),
        account_(account),
        surfaces_(context) {}

  /// Returns the request for `run`, the draw of a box. Measures what `known` lacks, and stores it there. The
  /// session must be locked. Throws Refusal, and what the service throws.
  RayCasterRequest request(const Run& run, const RecognisedRun& seen, KnownRayCaster known,
                           compositor::RenderService& service);

  /// Turns the nodes' image of a ray caster into what it shows, together with the parts that cropping has left
  /// behind the nearest. Renders these, and adds their figures to `counts`.
  void complete_image(const March& march, ImageRequest& asked, compositor::RenderService& service,
                      volume::Image& image, volume::FrameCounts& counts);

 private:
  struct Draw;

  ProxyBox find_box(Draw& draw);
  static std::vector<CoordinateSpace> spaces_of(const Draw& draw);
  /// Returns the part of the texture that a draw shows, whichever of its spaces it is in.
  static volume::Box region_in_any(const Draw& draw, const ProxyBox& box);
  /// Throws the last refusal if there were several in a row. In some frames it does not, so that the draw is
  /// measured once more.
  void refuse_again(const Draw& draw) const;
  void follow_inside(Draw& draw, const ProxyBox& box, const MarchInputs& inputs);
  void wait_for_earlier_drawing() const;
  std::string_view why_measured(const Draw& draw, const ProxyBox& box, const MarchInputs& inputs,
                                const std::vector<bool>& follows, bool turned) const;
  /// Returns a march that was measured before the last one and holds again, as in a viewer that alternates
  /// between a few; it becomes the last one measured.
  std::optional<March> measured_before(const Draw& draw, const ProxyBox& box, const MarchInputs& inputs) const;
  /// Returns the march whose table was measured, with the steps that the program has now; null if more is new.
  std::optional<March> with_other_steps(const Draw& draw, const ProxyBox& box, const MarchInputs& inputs,
                                        std::span<const TableContents> tables) const;
  ProxyBox measure(Draw& draw, const ProxyBox& box, const MarchInputs& inputs,
                   compositor::RenderService& service);
  volume::RenderRequest compose(const Draw& draw, const March& march, const ProxyBox& box);
  ImageRequest ask(const Draw& draw, const March& march, const ProxyBox& box,
                   volume::RenderRequest composed) const;
  volume::Rect kept_window(const Draw& draw, const ProxyBox& box, const MarchInputs& inputs,
                           const ProgramFindings& says) const;
  /// Returns the march whose image is most like the application's.
  March choose_march(Draw& draw, compositor::RenderService& service, const std::vector<March>& marches);

  const GlContext& context_;
  ShareGroup& group_;
  RenderSession& session_;
  ProgramReader& programs_;
  Uploader& uploader_;
  Classifier& classifier_;
  RequestComposer& composer_;
  FrameAccount& account_;
  ProbeSurfaces surfaces_;
};

/// Whether the nodes' image is not yet what the application shows, and must go through complete_image().
bool is_finished_here(const ImageRequest& image, const std::optional<March>& march);

}  // namespace understudy::spu
