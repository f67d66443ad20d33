// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/merging/run_merger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <utility>

#include "compositor/logging/log.h"
#include "compositor/service.h"
#include "spu/track/share_group.h"
#include "spu/volume/classification/texel_inputs.h"
#include "spu/volume/context/saved_state.h"
#include "spu/volume/merging/merged_geometry.h"
#include "spu/volume/merging/merged_upload.h"
#include "spu/volume/request/explanation.h"
#include "spu/volume/texture/value_range.h"
#include "volume/footprint.h"
#include "volume/texel_box.h"

namespace understudy::spu {
namespace {

/// The whole must have been shown in this many frames before the nodes forget the bricks.
constexpr std::uint64_t frames_before_bricks_go = 16;

/// Binds a run's texture to the unit where it was bound when it was drawn; sampler objects stay.
class BoundAgain {
 public:
  BoundAgain(const DispatchTable& gl, const SampledTexture& sampled) : gl_(gl), unit_(sampled.unit) {
    gl_.GetIntegerv(GL_ACTIVE_TEXTURE, &active_);
    gl_.ActiveTexture(GLenum(GL_TEXTURE0 + unit_));
    gl_.GetIntegerv(GL_TEXTURE_BINDING_3D, &bound_);
    gl_.BindTexture(GL_TEXTURE_3D, sampled.texture);
  }
  ~BoundAgain() {
    gl_.ActiveTexture(GLenum(GL_TEXTURE0 + unit_));
    gl_.BindTexture(GL_TEXTURE_3D, GLuint(bound_));
    gl_.ActiveTexture(GLenum(active_));
  }
  BoundAgain(const BoundAgain&) = delete;
  BoundAgain& operator=(const BoundAgain&) = delete;

 private:
  const DispatchTable& gl_;
  int unit_;
  GLint active_ = 0;
  GLint bound_ = 0;
};

}  // namespace

bool RunMerger::still_known(const Pipeline& pipeline, const RecognisedRun& seen,
                            const TextureDescription& texture, const MergedVolume& merged) const {
  const std::size_t place = *merged.place_of(pipeline.volume.texture);
  const volume::TexelBox read = texels_read(seen.slices.region, texture.size, texture.filter);
  // The transfer function was probed for the values that were known.
  const bool other_values = has_value_range(texture.type) && seen.texture_version != merged.versions[place];
  return alike(texture, merged.descriptions[place]) && texture.size == merged.descriptions[place].size &&
         volume::contains(merged.shown[place], read) && !other_values;
}

MergedVolume* RunMerger::volume_of(const Pipeline& pipeline, const RecognisedRun& seen,
                                   const KnownVolume& volume) const {
  if (pipeline.stack || seen.ray_caster || volume.frames == 0 || (pipeline.depth_test && pipeline.depth_write))
    return nullptr;
  MergedVolume* const merged = merged_.volume_with(pipeline.volume.texture);
  return merged != nullptr && merged->shown_as_one(stages_.account.frames()) ? merged : nullptr;
}

std::optional<ImageRequest> RunMerger::request_of(const Pipeline& pipeline, const RecognisedRun& seen,
                                                  KnownVolume& volume, const MergedVolume& merged) {
  SentVolume& sent = volume.sent;
  if (has_value_range(sent.texture.type)) sent.range = merged.volume.sent.range;
  ImageRequest image = stages_.slices.compose(pipeline, seen, {sent, volume.colours, *volume.counters});
  if (image.request.slice_segment || image.request.fog) return std::nullopt;
  return image;
}

VerificationSchedule::Inputs RunMerger::inputs_of(const MergedVolume& merged, const ImageRequest& image) const {
  using Effect = VerificationSchedule::Effect;
  // The mixture differs for any two states of the textures.
  constexpr std::uint64_t prime = 0x100000001b3;
  std::uint64_t version = 0;
  for (const GLuint texture : merged.textures)
    version = (version * prime) ^ stages_.group.texture_version(texture);
  const SentVolume& sent = merged.volume.sent;
  const int entries = table_entries(sent.texture, sent.range);
  VerificationSchedule::Inputs inputs = image.inputs;
  append_texels(version, effect_on_samples(sent.texture, sent.range, entries, Effect::measured), inputs);
  return inputs;
}

bool RunMerger::goes_with_held(const MergedVolume& merged, const Pipeline& pipeline,
                               const volume::RenderRequest& request) const {
  if (held_.empty()) return true;
  const auto same_texture = [&](const HeldRun& other) {
    return other.pipeline().volume.texture == pipeline.volume.texture;
  };
  return held_volume_ == &merged && !std::any_of(held_.begin(), held_.end(), same_texture) &&
         alike(held_.front().pipeline(), held_.front().image.request, pipeline, request);
}

bool RunMerger::holds(std::unique_ptr<Run>& run, RecognisedRun& seen, KnownVolume& volume) {
  const Pipeline& pipeline = run->pipeline();
  MergedVolume* const merged = volume_of(pipeline, seen, volume);
  if (merged == nullptr) return false;
  {
    // Without nodes this throws, and the application draws: runs must not wait.
    const auto lock = stages_.session.lock();
    process_counters().nodes = stages_.session.service().nodes();
  }
  volume.sent.texture = stages_.uploader.describe(pipeline, 0);
  count_texture(*volume.counters, volume.sent.texture);
  if (!still_known(pipeline, seen, volume.sent.texture, *merged)) {
    settle();
    merged_.learn_anew(pipeline.volume.texture,
                       texels_read(seen.slices.region, volume.sent.texture.size, volume.sent.texture.filter));
    return false;
  }
  auto image = request_of(pipeline, seen, volume, *merged);
  if (!image) return false;
  if (!goes_with_held(*merged, pipeline, image->request)) settle();
  if (held_.empty()) {
    const volume::RenderRequest whole = placed_as_whole(*merged, pipeline.volume.texture, image->request);
    merged->volume.verified.schedule.begin(inputs_of(*merged, *image),
                                           volume::footprint(whole, whole.region).pixels());
    comparison_.begin(*merged, *run, image->request);
  }
  comparison_.add(*run);
  held_.reserve(held_.size() + 1);
  held_volume_ = merged;
  held_.push_back({std::move(run), std::move(seen), std::move(*image), &volume});
  if (held_.size() == merged->textures.size()) settle();
  return true;
}

void RunMerger::forget_held() {
  held_.clear();
  comparison_.end();
  spent_ = {};
}

void RunMerger::count_held(const FrameShares& spent) {
  if (!held_.empty()) spent_ += spent;
}

void RunMerger::settle() {
  if (held_.empty()) return;
  FrameClock& clock = stages_.account.clock();
  std::vector<HeldRun> held = std::exchange(held_, {});
  MergedVolume& merged = *held_volume_;
  std::optional<double> native_ms;
  std::exception_ptr trouble;
  {
    const TimedShare timed(clock, &FrameShares::recognition);
    nothing_held_();
    try {
      native_ms = show_held(merged, held);
    } catch (const std::exception&) {
      trouble = std::current_exception();
    }
    comparison_.end();
  }
  const FrameShares spent = clock.take();
  stages_.account.note([&](FrameRecord& frame) { frame.spent_ms += spent; });
  spent_ += spent;
  const FrameShares all_spent = std::exchange(spent_, {});
  if (speed_is_guarded()) count_speed(merged.volume, trouble == nullptr, all_spent, native_ms);
  if (trouble) std::rethrow_exception(trouble);
}

bool RunMerger::speed_is_guarded() const {
  const auto lock = stages_.session.lock();
  return stages_.session.options().speed_guard && !stages_.session.settings().tint;
}

std::optional<double> RunMerger::show_held(MergedVolume& merged, std::vector<HeldRun>& held) {
  const bool all = held.size() == merged.textures.size();
  if (all && shows_as_one(merged, held)) return merged.volume.verified.schedule.native_ms();
  if (all && comparison_.begun()) distrust(held);
  std::optional<double> native_ms = 0;
  std::exception_ptr trouble;
  for (HeldRun& each : held) {
    const auto of_brick = each.volume->verified.schedule.native_ms();
    native_ms = native_ms && of_brick ? std::optional(*native_ms + *of_brick) : std::nullopt;
    try {
      show_alone(each);
    } catch (const std::exception&) {
      trouble = std::current_exception();
    }
  }
  if (trouble) std::rethrow_exception(trouble);
  return native_ms;
}

std::optional<volume::FrameCounts> RunMerger::show_whole(MergedVolume& merged, const std::vector<HeldRun>& held,
                                                         ImageRequest& image,
                                                         compositor::RenderService& service) {
  const HeldRun& first = held.front();
  std::vector<BrickVersion> versions;
  for (const HeldRun& each : held)
    // NOLINTNEXTLINE(performance-inefficient-vector-operation): a few
    versions.push_back({each.pipeline().volume.texture, each.seen.texture_version});
  upload_merged(stages_.context, stages_.group, stages_.session, stages_.uploader, stages_.account, merged,
                versions, first.pipeline().volume, service);
  image.request.volume = merged.volume.sent.description.id;
  image.request.version = merged.volume.sent.description.version;
  KnownVolume& volume = merged.volume;
  image.request.exact = comparison_.begun();
  const ImageToShow what{first.pipeline(), image, volume, first.run->volume_texture(), comparison_.whole()};
  try {
    return stages_.presentation.show(service, what, [&](const volume::ImageView& shown) {
      comparison_.check(first.pipeline(), shown, volume);
    });
  } catch (const Refusal& refusal) {
    const auto& native = comparison_.shown_instead();
    if (!native) throw;
    stages_.presentation.show_native(service, what, {native->rect, native->rgba});
    leave(held, refusal);
    return std::nullopt;
  }
}

bool RunMerger::shows_as_one(MergedVolume& merged, std::vector<HeldRun>& held) {
  KnownVolume& volume = merged.volume;
  bool shown = false;
  try {
    const Pipeline& pipeline = held.front().pipeline();
    std::vector<BrickSlices> bricks;
    // NOLINTNEXTLINE(performance-inefficient-vector-operation): a few
    for (const HeldRun& each : held) bricks.push_back({each.pipeline().volume.texture, &each.seen});
    MergedSlices whole = merged_slices(merged, bricks, pipeline);
    ImageRequest image;
    image.request = held.front().image.request;
    image.request.texture_to_clip = whole.camera.texture_to_clip;
    image.request.planes = whole.slices.planes;
    image.request.region = whole.slices.region;
    image.request.clip_planes = std::move(whole.clip_planes);
    stages_.composer.hide_behind_geometry(pipeline, image.request);
    const auto lock = stages_.session.lock();
    const auto counts = show_whole(merged, held, image, stages_.session.service());
    shown = true;
    if (!counts) return true;
    for (std::size_t k = 0; k < 3; ++k) volume.counters->size[k] = merged.tiling.size[k];
    if (volume.frames == 0 || stages_.session.options().explain)
      put_text(volume.counters->explanation,
               fmt::format("merged of {} textures: {}", merged.textures.size(),
                           explanation(pipeline, volume.sent.texture, image, whole.camera.residual)));
    for (const HeldRun& each : held) ++each.volume->frames;
    if (++volume.frames == frames_before_bricks_go) forget_single_bricks(merged);
    count_substituted(volume, *counts, stages_.account);
    return true;
  } catch (const Refusal& refusal) {
    volume.refusals.last_reason = refusal.reason;
  } catch (const compositor::ServiceLost& lost) {
    const auto lock = stages_.session.lock();
    stages_.session.lost(lost);
    return false;
  } catch (const std::exception& error) {
    if (shown) throw;
    volume.refusals.last_reason = error.what();
  }
  // After a failed comparison it is tried again; another reason holds in every frame.
  if (!volume.refusals.pauses(stages_.account.frames()))
    volume.refusals.handed_back = volume.refusals.last_reason;
  logging::log(logging::Level::warn, "{} textures of one volume are shown one by one: {}",
               merged.textures.size(), volume.refusals.last_reason);
  return false;
}

void RunMerger::distrust(const std::vector<HeldRun>& held) {
  for (const HeldRun& each : held) {
    each.volume->verified.schedule.ask_for_whole();
    each.volume->colours.probed.reset();
  }
}

void RunMerger::leave(const std::vector<HeldRun>& held, const Refusal& refusal) {
  distrust(held);
  for (const HeldRun& each : held) {
    volumes_.refuse(each.pipeline().volume.texture, refusal, stages_.account, &each == &held.front());
  }
}

void RunMerger::forget_single_bricks(const MergedVolume& merged) {
  for (const GLuint texture : merged.textures) {
    SentVolume& brick = volumes_.find(texture)->sent;
    if (brick.generation == stages_.session.generation()) stages_.session.forget(brick.description.id);
    brick.generation = 0;
  }
}

volume::FrameCounts RunMerger::show(HeldRun& run, compositor::RenderService& service) {
  KnownVolume& volume = *run.volume;
  const bool compared_whole = stages_.verifier.whole_due(volume.verified, false, volume.frames);
  const auto unverified = [](const volume::ImageView&) {};
  return stages_.presentation.show(
      service, {run.pipeline(), run.image, volume, run.run->volume_texture(), compared_whole}, unverified);
}

volume::FrameCounts RunMerger::show_by_session(HeldRun& run) {
  KnownVolume& volume = *run.volume;
  const Pipeline& pipeline = run.pipeline();
  const auto lock = stages_.session.lock();
  compositor::RenderService& service = stages_.session.service();
  {
    const BoundAgain bound(*stages_.context.gl, pipeline.volume);
    volume.sent.texture = stages_.uploader.describe(pipeline, 0);
    count_texture(*volume.counters, volume.sent.texture);
    stages_.uploader.upload(
        {pipeline, {}, run.seen.texture_version, run.seen.slices.region, run.seen.slice_segments}, volume.sent,
        *volume.counters, service);
  }
  run.image.request.volume = volume.sent.description.id;
  run.image.request.version = volume.sent.description.version;
  return show(run, service);
}

volume::FrameCounts RunMerger::show_by_itself(HeldRun& run) {
  const auto service = compositor::embedded_service();
  const TextureDescription& texture = run.volume->sent.texture;
  volume::VolumeDescription description = run.volume->sent.description;
  description.size = texture.size;
  description.type = texture.type;
  description.wrap = texture.wrap;
  description.border = texture.border;
  description.stored = {{0, 0, 0}, description.size};
  description.id = 1;
  {
    const SavedState saved(stages_.context);
    const BoundAgain bound(*stages_.context.gl, run.pipeline().volume);
    BlockHashes hashes(description.stored, description.type);
    const auto source = texture_source(stages_.context, run.pipeline().volume.texture, texture);
    send_volume(*service, description, *source, hashes);
  }
  run.image.request.volume = description.id;
  run.image.request.version = description.version;
  const auto lock = stages_.session.lock();  // of the settings
  return show(run, *service);
}

void RunMerger::show_alone(HeldRun& run) {
  KnownVolume& volume = *run.volume;
  std::optional<volume::FrameCounts> counts;
  bool hidden = false;
  const auto hide = [&] {
    if (!hidden) stages_.composer.hide_behind_geometry(run.pipeline(), run.image.request);
    hidden = true;
  };
  try {
    hide();
    counts = show_by_session(run);
    ++volume.frames;
  } catch (const compositor::ServiceLost& lost) {
    const auto lock = stages_.session.lock();
    stages_.session.lost(lost);
  } catch (const Refusal&) {
    // The texture cannot be read as before; the last attempt below reports why.
  } catch (const std::exception&) {
    // Refused, perhaps for lack of memory; the result of the last attempt below is reported.
  }
  if (counts) return count_substituted(volume, *counts, stages_.account);
  // The run's calls cannot be replayed any more: it is rendered in this process.
  try {
    hide();
    counts = show_by_itself(run);
    count_substituted(volume, *counts, stages_.account);
  } catch (const std::exception& error) {
    volume.refusals.handed_back = error.what();
    volumes_.refuse(run.pipeline().volume.texture, Refusal{error.what()}, stages_.account);
  }
}

}  // namespace understudy::spu
