// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/slices/slice_stage.h"

#include <utility>

#include "compositor/service.h"
#include "spu/volume/classification/texel_inputs.h"
#include "spu/volume/texture/value_range.h"

namespace understudy::spu {

ImageRequest SliceStage::compose(const Pipeline& pipeline, const RecognisedRun& seen, KnownSlices known) {
  const SentVolume& sent = known.sent;
  SliceColours colours =
      classifier_.classify(pipeline, seen, sent.texture, sent.range, known.colours, known.counters);
  ImageRequest image;
  volume::RenderRequest& request = image.request;
  request = composer_.compose(pipeline, *seen.fit, seen.slices.region, sent.description, sent.texture.filter);
  request.planes = seen.slices.planes;
  request.clip_planes = seen.clip_planes;
  request.classification = std::move(colours.classification);
  request.fog = std::move(colours.fog);
  request.slice_segment = colours.slice_segment;
  image.inputs = std::move(colours.inputs);
  return image;
}

ImageRequest SliceStage::request(const Pipeline& pipeline, const RecognisedRun& seen, KnownSlices known,
                                 compositor::RenderService& service) {
  SentVolume& sent = known.sent;
  sent.texture = uploader_.describe(pipeline, seen.stack.size());
  count_texture(known.counters, sent.texture);
  uploader_.upload({pipeline, seen.stack, seen.texture_version, seen.slices.region, seen.slice_segments}, sent,
                   known.counters, service);
  ImageRequest image = compose(pipeline, seen, known);
  using Effect = VerificationSchedule::Effect;
  const Effect effect =
      effect_on_samples(sent.texture, sent.range, table_entries(sent.texture, sent.range), Effect::measured);
  append_texels(sent.description.version, effect, image.inputs);
  composer_.hide_behind_geometry(pipeline, image.request);
  return image;
}

}  // namespace understudy::spu
