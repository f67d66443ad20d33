// SPDX-License-Identifier: Apache-2.0
// The stage for slices: makes a request of a recognised run, by upload, classification and composition.
#pragma once

#include "spu/volume/classification/classifier.h"
#include "spu/volume/request/image_request.h"
#include "spu/volume/request/request_composer.h"
#include "spu/volume/upload/uploader.h"

namespace understudy::compositor {
class RenderService;
}

namespace understudy::spu {

/// What is remembered of the volume that slices draw.
struct KnownSlices {
  SentVolume& sent;
  KnownColours& colours;
  VolumeCounters& counters;
};

class SliceStage {
 public:
  SliceStage(Uploader& uploader, Classifier& classifier, RequestComposer& composer)
      : uploader_(uploader), classifier_(classifier), composer_(composer) {}

  /// Returns the request for `seen`, drawn by `pipeline`. Sends texels and probes colours unless `known` is
  /// still valid, and stores the results there. Requires the session's lock. Throws Refusal, and what the
  /// service throws.
  ImageRequest request(const Pipeline& pipeline, const RecognisedRun& seen, KnownSlices known,
                       compositor::RenderService& service);

  /// The same without sending texels, and without what hides the volume.
  ImageRequest compose(const Pipeline& pipeline, const RecognisedRun& seen, KnownSlices known);

 private:
  Uploader& uploader_;
  Classifier& classifier_;
  RequestComposer& composer_;
};

}  // namespace understudy::spu
