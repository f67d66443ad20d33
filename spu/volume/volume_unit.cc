// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/volume_unit.h"

#include <cmath>
#include <optional>
#include <utility>

#include "compositor/rendered.h"
#include "compositor/service.h"
#include "spu/state_value.h"
#include "spu/track/share_group.h"
#include "spu/volume/context/indexed_state.h"
#include "spu/volume/depth/deferred_depth_write.h"
#include "spu/volume/observation/draw_slots.h"
#include "spu/volume/observation/enclosing_calls.h"
#include "spu/volume/observation/indexed_state_calls.h"
#include "spu/volume/observation/program_binaries.h"
#include "spu/volume/request/explanation.h"
#include "spu/volume/stages.h"
#include "volume/footprint.h"

namespace understudy::spu {
namespace {

using Clock = std::chrono::steady_clock;

/// Fewer textured quads in a row are not examined.
constexpr std::size_t fewest_stack_slices = 8;
/// Until so many images of a volume were shown, new kinds of state are those that every frame sets.
constexpr std::uint64_t frames_of_first_state = 2;

/// Returns the density of samples in texture space over rays of all directions; 1 for slices.
double sample_density(const volume::RenderRequest& request) {
  if (!request.steps) return 1;
  double square = 0;
  for (const double number : request.steps->metric) square += number * number;
  return square > 0 ? std::sqrt(square) : 1;
}

}  // namespace

/// A recognised run with the request and the camera that render it.
struct VolumeUnit::Recognised {
  const RecognisedRun& seen;
  ImageRequest& image;
  const CameraFit& camera;
};

/// Exists while the unit makes calls of its own: neither their errors nor their state remain.
struct VolumeUnit::OwnCalls {
  explicit OwnCalls(VolumeUnit& unit) : errors(*unit.context().gl, unit.kept_errors) {
    if (unit.chain().group().has_indexed_state()) state.emplace(unit.context());
  }

  OwnErrors errors;
  std::optional<IndexedState> state;
};

VolumeUnit::VolumeUnit(Chain& chain, std::shared_ptr<RenderSession> session)
    : DrawObserver(chain),
      session_(std::move(session)),
      settings_(session_ ? session_->wanted_settings().get() : LiveSettings()),
      volumes_(chain.group(), session_),
      frame_started_(Clock::now()) {}

VolumeUnit::~VolumeUnit() {
  if (session_) session_->ledger().forget(this);
}

Stages& VolumeUnit::stages() {
  if (!stages_)
    stages_ =
        std::make_unique<Stages>(context(), chain().group(), *session_, volumes_, samplers(), this, [this] {
          if (!run_open()) chain().set_phase(resting_phase());
        });
  stages_->views.draws_into(window_);
  return *stages_;
}

std::optional<View> VolumeUnit::note_view(const Run& run) {
  if (session_->options().frame_latency == 0) return std::nullopt;
  const GLuint texture = run.volume_texture();
  const std::uint64_t frame = session_->windows().frame(window_);
  DrawnViews& views = stages().views;
  if (run.inside_begin) {
    // OpenGL must not be queried.
    views.drawn_somewhere(texture, frame);
    return std::nullopt;
  }
  const View view = current_view(context(), texture, window_);
  views.drawn(view, frame);
  return view;
}

void VolumeUnit::fill(Phase phase, DispatchTable& table) {
  // A list sets indexed state when it is called, which shows when it is compiled.
  if (phase == Phase::compiling) fill_indexed_state_slots(table);
  if (phase == Phase::plain) {
    fill_enclosing_call_slots(table);
    fill_indexed_state_slots(table);
    fill_stack_detection_slots(table);
  }
  if (phase == Phase::watching) fill_watching_slots(table);
  if (phase == Phase::depth_deferred) fill_depth_deferred_slots(table);
  if (phase == Phase::deferring) fill_deferring_slots(table);
  // In Phase::deferring, the call closes the run and goes on to the phase that begins then.
  if (phase != Phase::compiling && phase != Phase::deferring) fill_program_binary_slots(table);
  fill_error_slot(table);  // errors may be kept in any phase, as volumes may have been deleted since
}

bool VolumeUnit::leaves_all(const Pipeline& pipeline) {
  if (settings_.substitutes) return false;
  const GLuint texture = pipeline.volume.texture;
  // Of textures that may be a stack, only those that were one are counted.
  if (!pipeline.stack || volumes_.find(texture) != nullptr)
    volumes_.leave_in_this_frame(texture, "switched off with understudy ctl", stages().account);
  return true;
}

void VolumeUnit::refuse_in_this_frame(GLuint texture, const Refusal& refusal) {
  // One line for all bricks of a volume.
  const MergedVolume* const merged = stages().merged.volume_with(texture);
  const bool say = merged == nullptr || merged->textures.front() == texture;
  volumes_.refuse_in_this_frame(texture, refusal, stages().account, say);
  if (session_->options().frame_latency > 0)
    stages().views.drawn_somewhere(texture, session_->windows().frame(window_));
}

bool VolumeUnit::substitutes(std::unique_ptr<Run>& run) {
  const GLuint texture = run->volume_texture();
  const std::optional<View> view = note_view(*run);
  const bool shown = [&] {
    const OwnCalls own(*this);
    return shows(run);
  }();
  if (view && !shown) session_->windows().shown(*view, false);
  FrameAccount& account = stages().account;
  const FrameShares spent = account.clock().take();
  account.note([&](FrameRecord& frame) { frame.spent_ms += spent; });
  // No volume is found for a stack of textures that turned out not to be one.
  if (run == nullptr) {
    stages().merger.count_held(spent);
    return shown;
  }
  KnownVolume* const volume = volumes_.find(texture);
  const bool guarded = session_->options().speed_guard && !settings_.tint;
  if (volume != nullptr && guarded) count_speed(*volume, shown, spent, volume->verified.schedule.native_ms());
  return shown;
}

bool VolumeUnit::shows(std::unique_ptr<Run>& run) {
  FrameAccount& account = stages().account;
  const TimedShare timed(account.clock(), &FrameShares::recognition);
  if (run->pipeline().stack && !is_a_stack(*run)) {
    inside_begin = run->inside_begin;
    return false;
  }
  const GLuint texture = run->volume_texture();
  if (run->inside_begin) {
    volumes_.refuse(texture, "calls other than vertices between glBegin and glEnd", account);
    inside_begin = true;
    return false;
  }
  try {
    if (auto refusal = standing_refusal(texture, run->pipeline().program)) throw Refusal{std::move(*refusal)};
    substitute(run);
    return true;
  } catch (const Refusal& refusal) {
    ++volumes_.of(texture).refusals.in_a_row;
    volumes_.refuse(texture, refusal, account);
  } catch (const NothingVisible&) {
  } catch (const compositor::RequestRefused& refused) {
    volumes_.refuse(texture, refused.what(), account);
  } catch (const compositor::ServiceLost& lost) {
    const auto lock = session_->lock();
    session_->lost(lost);
    // Whoever started the nodes, or the session, prints the loss once.
    volumes_.refuse(texture, lost.reason(), account, false);
  } catch (const std::exception& error) {
    volumes_.refuse(texture, error.what(), account);
  }
  return run == nullptr || run->shown;
}

std::optional<Refusal> VolumeUnit::standing_refusal(GLuint texture, GLuint program) {
  if (auto refusal = volumes_.standing_refusal(texture)) return refusal;
  MergedVolume* const merged = stages().merged.volume_with(texture);
  return merged != nullptr && merged->shown_as_one(stages().account.frames())
             ? stages().merged.speed_refusal(*merged, program)
             : volumes_.speed_refusal(texture, program);
}

bool VolumeUnit::is_a_stack(const Run& run) {
  if (run.inside_begin || run.slices().size() < fewest_stack_slices) return false;
  if (volumes_.find(run.volume_texture()) != nullptr) return true;
  try {
    stages().recogniser.find_geometry(run, {});
    stacks.looked_at(true);
    return true;
  } catch (const Refusal&) {
    stacks.looked_at(false);
  } catch (const NothingVisible&) {
  }
  return false;
}

void VolumeUnit::tidy() {
  // A frame may end in another context than the one that draws.
  const std::uint64_t frame = session_->ledger().frames();
  if (frame == tidied_in_frame_) return;
  settle_held();
  stages().merged.find();
  forget_deleted_volumes();
  tidied_in_frame_ = frame;
}

void VolumeUnit::substitute(std::unique_ptr<Run>& run) {
  tidy();
  KnownVolume& volume = volumes_.of(run->volume_texture());
  RecognisedRun seen = stages().recogniser.recognise(*run, known_coordinate(volume.march));
  if (deferred_depth.empty() && stages().merger.holds(run, seen, volume)) return;
  settle_held();
  const auto lock = session_->lock();
  compositor::RenderService& service = session_->service();
  process_counters().nodes = service.nodes();
  if (seen.ray_caster) {
    RayCasterRequest asked = stages().ray_casters.request(
        *run, seen,
        {volume.march, volume.sent, volume.verified, volume.refusals, volume.frames, *volume.counters},
        service);
    show(*run, {seen, asked.image, asked.camera}, volume, service);
  } else {
    ImageRequest image = stages().slices.request(run->pipeline(), seen,
                                                 {volume.sent, volume.colours, *volume.counters}, service);
    show(*run, {seen, image, *seen.fit}, volume, service);
  }
}

void VolumeUnit::show(Run& run, const Recognised& recognised, KnownVolume& volume,
                      compositor::RenderService& service) {
  Stages& stages = this->stages();
  ImageRequest& image = recognised.image;
  volume::RenderRequest& request = image.request;
  if (volume.colours.rounding.rounds()) round_samples(request);
  // A ray caster that was measured anew starts at frame 0: earlier comparisons do not apply to it.
  if (volume.frames == 0) volume.verified.schedule.ask_for_whole();
  // The first frames set most kinds, in part after the volume was drawn.
  const bool new_state = volume.verified.state_kinds != state_kinds.count();
  if (new_state && volume.frames >= frames_of_first_state) volume.verified.schedule.ask_for_whole();
  volume.verified.state_kinds = state_kinds.count();
  if (image.unproven) volume.verified.schedule.ask_for_several();
  volume.verified.schedule.begin(image.inputs, volume::footprint(request, request.region).pixels(),
                                 sample_density(request));
  const bool compared_whole = stages.verifier.whole_due(volume.verified, image.eye_inside, volume.frames);
  const LiveSettings& settings = session_->settings();
  // An image within a budget is not compared with the viewer's: its error is measured, if that was requested.
  const bool measured = settings.has_budget() ? settings.error > 0 : volume.verified.schedule.sentinels() > 0;
  request.exact = compared_whole || measured;
  std::optional<SceneCandidate> scene = stages.scenes.candidate(run, image, volume);
  const auto check = [&](const volume::ImageView& shown) {
    auto comparison = stages.verifier.verify(
        {run, request, image.uncut_window.value_or(request.window), image.eye_inside, volume.frames}, shown,
        volume.verified, *volume.counters);
    if (comparison && image.background_alone) comparison->difference.anything_visible = false;
    if (comparison && !comparison->right) try_rounding(run.pipeline(), image, volume, service);
    take_comparison(comparison, volume, session_->ledger().frames());
    if (scene) stages.scenes.look_at(*scene, comparison, shown);
  };
  const auto& capture = recognised.seen.capture;
  const volume::FrameCounts counts =
      stages.presentation.show(service,
                               {run.pipeline(), image, volume, run.volume_texture(), compared_whole,
                                capture ? &capture->polygons : nullptr},
                               check);
  run.shown = true;
  if (scene) stages.scenes.keep(std::move(*scene));
  // An image that replaces pixels is drawn with the box, which writes its depth itself.
  if (!image.replaces_pixels) {
    if (const auto watched = stages.depth.settle(run, image.uncut_window.value_or(request.window),
                                                 volume.frames == 0, depth_is_read(volume))) {
      depth_looked_at(deferred_depth.add(*watched));
      chain().set_phase(Phase::depth_deferred);
    }
  }
  if (volume.frames == 0 || session_->options().explain)
    put_text(volume.counters->explanation,
             explanation(run.pipeline(), volume.sent.texture, image, recognised.camera.residual));
  ++volume.frames;
  stages.merged.note_brick(run.pipeline(), recognised.seen, request, volume.sent.texture);
  count_substituted(volume, counts, stages.account);
}

bool VolumeUnit::depth_is_read(const KnownVolume& volume) {
  if (volume.depth_looked_at) return true;
  return !defers_window_depth_ && state_value(*context().gl, GL_DRAW_FRAMEBUFFER_BINDING) == 0;
}

void VolumeUnit::try_rounding(const Pipeline& pipeline, const ImageRequest& image, KnownVolume& volume,
                              compositor::RenderService& service) {
  SampleRounding& rounding = volume.colours.rounding;
  if (!rounding.may_explain_loss(volume.sent.texture) || is_finished_here(image, volume.march.march)) return;
  volume::RenderRequest rounded = image.request;
  round_samples(rounded);
  if (rounded.filter == image.request.filter) return;
  const TimedShare timed(stages().account.clock(), &FrameShares::render);
  if (!stages().verifier.would_have_been_right(pipeline, service.render(rounded).image)) rounding.refute();
}

Phase VolumeUnit::resting_phase() const {
  if (stages_ && !stages_->merger.empty()) return Phase::deferring;
  return !deferred_depth.empty() ? Phase::depth_deferred : Phase::watching;
}

void VolumeUnit::settle_held() {
  if (!stages_ || stages_->merger.empty()) return;
  const OwnCalls own(*this);
  stages_->merger.settle();
}

void VolumeUnit::depth_looked_at(const std::vector<GLuint>& volumes) {
  // The next runs of these volumes write their depth.
  for (const GLuint texture : volumes) {
    if (KnownVolume* const volume = volumes_.find(texture)) volume->depth_looked_at = true;
  }
  if (!volumes.empty()) depth_gone();
}

void VolumeUnit::depth_gone() {
  if (deferred_depth.empty()) chain().set_phase(Phase::watching);
}

void VolumeUnit::export_scenes() {
  // Calls would be recorded in the list.
  if (!stages_ || stages_->scenes.empty() || chain().phase() == Phase::compiling) return;
  const Clock::time_point start = Clock::now();
  const OwnCalls own(*this);
  stages_->scenes.write(stages_->merged);
  frame_started_ += Clock::now() - start;  // not a part of the frame's time
}

void VolumeUnit::frame_ended(FrameEnd kind) {
  export_scenes();
  if (kind != FrameEnd::wait) take_settings();
  // Another context may sample a depth texture that is attached here.
  if (kind == FrameEnd::make_current) depth_looked_at(deferred_depth.take_textures(std::nullopt));
  if (kind != FrameEnd::swap && kind != FrameEnd::finish) return;
  // After a swap the window's depth is undefined.
  if (kind == FrameEnd::swap && !deferred_depth.take_cleared(0, std::nullopt).empty()) depth_gone();
  FrameRecord frame = session_->ledger().close(this);
  frame.time_ms = std::chrono::duration<double, std::milli>(Clock::now() - frame_started_).count();
  report_frame(frame, session_->options().explain);
  frame_started_ = Clock::now();
  forget_deleted_volumes();
  if (!volumes_.empty() || !stacks.frame_without_volume()) return;
  end_stack_watch();
  if (chain().phase() == Phase::watching && !chain().group().has_volumes()) chain().set_phase(Phase::plain);
}

void VolumeUnit::take_settings() {
  const std::uint64_t version = session_->wanted_settings().version();
  if (version == settings_version_) return;
  const auto taken = session_->take_wanted_settings();
  if (!taken) return;
  settings_version_ = version;
  settings_ = *taken;
}

void VolumeUnit::forget_deleted_volumes() {
  if (stages_) stages_->merged.forget_deleted();
  volumes_.forget_deleted();
}

void VolumeUnit::abandon() {
  drop_run();
  end_stack_watch();
  volumes_.forget_all();
  if (!stages_) return;
  stages_->programs.forget();
  stages_->scenes.forget();
  stages_->merged.forget_all();
  stages_->merger.forget_held();
}

}  // namespace understudy::spu
