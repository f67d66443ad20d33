#include "spu/volume/volume_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "spu/report/skipped_work.h"
#include "spu/track/track.h"
#include "spu/volume/context/saved_state.h"
#include "spu/volume/depth/deferred_depth_write.h"
#include "spu/volume/depth/depth.h"
#include "spu/volume/geometry/feedback.h"
#include "spu/volume/merging/merging.h"
#include "spu/volume/observation/conditional_render.h"
#include "spu/volume/observation/draw_slots.h"
#include "spu/volume/observation/program_binaries.h"
#include "spu/volume/substitution.h"
#include "spu/volume/upload/texel_transfer.h"
#include "volume/footprint.h"
#include "volume/matrix.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Fewer textures in a row are no stack worth looking at.
constexpr std::size_t fewest_stack_slices = 8;
/// A viewer shows its stack before so many frames are over, or makes another.
constexpr int most_frames_without_stack = 600;

volume::Matrix4 projection_matrix(const DispatchTable& gl) {
  std::array<GLdouble, 16> column_major{};
  gl.GetDoublev(GL_PROJECTION_MATRIX, column_major.data());
  volume::Matrix4 matrix{};
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column)
      matrix[4 * row + column] = column_major[4 * column + row];
  }
  return matrix;
}

/// The row vector `plane` times `matrix`: how plane equations travel against points.
std::array<double, 4> plane_times(const std::array<double, 4>& plane, const volume::Matrix4& matrix) {
  std::array<double, 4> result{};
  for (std::size_t column = 0; column < 4; ++column) {
    for (std::size_t row = 0; row < 4; ++row) result[column] += plane[row] * matrix[4 * row + column];
  }
  return result;
}

/// The application's user clip planes, which OpenGL keeps in eye space, carried to texture space through the
/// camera.
std::vector<volume::HalfSpace> clip_planes_in_texture_space(const DispatchTable& gl,
                                                            const volume::Matrix4& texture_to_clip) {
  std::vector<volume::HalfSpace> planes;
  GLint count = 0;
  gl.GetIntegerv(GL_MAX_CLIP_PLANES, &count);
  std::optional<volume::Matrix4> clip_to_eye;
  for (GLint i = 0; i < count; ++i) {
    if (!gl.IsEnabled(GLenum(GL_CLIP_PLANE0 + i))) continue;
    if (!clip_to_eye) clip_to_eye = volume::inverse(projection_matrix(gl));
    if (!clip_to_eye) throw Refusal{"the projection matrix is singular"};
    std::array<double, 4> eye{};
    gl.GetClipPlane(GLenum(GL_CLIP_PLANE0 + i), eye.data());
    const auto texture = plane_times(plane_times(eye, *clip_to_eye), texture_to_clip);
    planes.push_back({{texture[0], texture[1], texture[2]}, texture[3]});
  }
  return planes;
}

bool clips_in_shader(const DispatchTable& gl) {
  GLint count = 0;
  gl.GetIntegerv(GL_MAX_CLIP_DISTANCES, &count);
  for (GLint i = 0; i < count; ++i) {
    if (gl.IsEnabled(GLenum(GL_CLIP_DISTANCE0 + i))) return true;
  }
  return false;
}

/// What fixed-function fog goes by: how far vertices lie from the plane through the eye.
std::vector<float> eye_distances(const DispatchTable& gl, std::span<const ObservedVertex> vertices) {
  const auto clip_to_eye = volume::inverse(projection_matrix(gl));
  if (!clip_to_eye) throw Refusal{"the projection matrix is singular"};
  std::vector<float> distances;
  for (const ObservedVertex& vertex : vertices) {
    const volume::Vec4 eye = volume::transform(*clip_to_eye, vertex.clip);
    distances.push_back(float(std::abs(eye[2] / eye[3])));
  }
  return distances;
}

/// Gives the observed slices of a stack their third coordinate. The end whose texture has the lower name is the
/// low one, from whichever side the stack is drawn.
std::vector<GLuint> place_slices(const Run& run, ObservedPolygons& polygons) {
  std::vector<GLuint> textures = run.slices();
  const bool downwards = textures.front() > textures.back();
  const auto n = double(textures.size());
  for (ObservedVertex& vertex : polygons.vertices) {
    const double place = (vertex.texture[2] + 0.5) / n;
    vertex.texture[2] = downwards ? 1 - place : place;
  }
  if (downwards) std::reverse(textures.begin(), textures.end());
  return textures;
}

/// The other value of inputs that nobody tells: a colour that depends on one of them is not the sample's alone.
constexpr std::array<float, 4> untold_value{0.75F, 0.75F, 0.75F, 1};

/// What an assembly program may read besides the coordinate and the primary colour, and feedback does not tell.
void append_untold_inputs(std::vector<StageInput>& inputs) {
  constexpr int coordinate_sets = 8;
  for (int set = 1; set < coordinate_sets; ++set)
    inputs.push_back({fmt::format("gl_TexCoord[{}]", set), GL_FLOAT_VEC4, 4, false});
  inputs.push_back({"gl_FrontSecondaryColor", GL_FLOAT_VEC4, 4, false});
  inputs.push_back({"gl_FogFragCoord", GL_FLOAT, 1, false});
}

}  // namespace

SliceOrder order_of(const Pipeline& pipeline) {
  if (pipeline.blending.front_to_back != FrontToBack::no) return SliceOrder::front_to_back;
  // Slices that write depth hide whatever comes later and lies behind them.
  const bool matters =
      pipeline.blending.op == volume::Operator::over || pipeline.blending.alpha.op == volume::Operator::over;
  return matters || (pipeline.depth_test && pipeline.depth_write) ? SliceOrder::back_to_front : SliceOrder::any;
}

VolumeUnit::VolumeUnit(Chain& chain, std::shared_ptr<RenderSession> session)
    : chain_(chain),
      session_(std::move(session)),
      merging_(std::make_unique<Merging>()),
      frame_started_(Clock::now()) {}

VolumeUnit::~VolumeUnit() {
  for (auto& [texture, volume] : known_)
    if (volume.counters != nullptr) leave_behind(*volume.counters);
  if (session_) session_->ledger().forget(this);
}

const GlContext& VolumeUnit::context() {
  if (!context_) context_ = describe_context(chain_.below(*this, Phase::plain));
  return *context_;
}

void VolumeUnit::fill(Phase phase, DispatchTable& table) {
  if (phase == Phase::plain) {
    fill_conditional_render_slots(table);
    fill_program_binary_slots(table);
    fill_stack_detection_slots(table);
  }
  if (phase == Phase::watching) fill_watching_slots(table);
  if (phase == Phase::depth_deferred) fill_depth_deferred_slots(table);
  if (phase == Phase::deferring) fill_deferring_slots(table);
}

KnownVolume& VolumeUnit::known(GLuint texture) {
  KnownVolume& volume = known_[texture];
  if (volume.counters == nullptr) {
    chain_.group().remember(texture);
    volume.counters = &count_volume(texture);
  }
  return volume;
}

void VolumeUnit::leave(GLuint texture, const std::string& reason, bool say) {
  KnownVolume& volume = known(texture);
  note([](FrameRecord& frame) { ++frame.left; });
  volume.counters->draws_left.fetch_add(1, std::memory_order_relaxed);
  const bool new_reason = volume.last_reason != reason;
  count_reason(*volume.counters, reason);
  volume.last_reason = reason;
  if (new_reason && say) {
    fmt::print(stderr, "understudy: volume {} not substituted: {}\n", texture, reason);
  }
}

std::string VolumeUnit::why_left(GLuint texture) {
  const KnownVolume& volume = known(texture);
  if (!volume.handed_back.empty()) return volume.handed_back;
  if (session_->ledger().frames() < volume.next_try) return volume.last_reason;
  return volume.speed.reason(Clock::now());
}

void VolumeUnit::count_speed(GLuint texture, const FrameShares& spent) {
  const Options& options = session_->options();
  KnownVolume& volume = known(texture);
  const auto native_ms = volume.verification.native_ms();
  if (!options.speed_guard || options.debug_tint || !native_ms) return;
  // Waiting for what was drawn before, and comparing, are not what the volume costs.
  const double ours_ms = spent.recognition + spent.upload + spent.render + spent.presentation + spent.budget;
  volume.speed.substituted(ours_ms, *native_ms, Clock::now());
}

bool VolumeUnit::opens_run() {
  if (begins_run()) return true;
  // Whatever else is drawn now goes on top of what waits.
  settle_held();
  return false;
}

bool VolumeUnit::begins_run() {
  if (inside_begin || !context().sufficient()) return false;
  const PipelineFinding finding = read_pipeline(context(), chain_.group(), samplers_, stacks_possible_);
  if (std::holds_alternative<NotAVolume>(finding)) return false;
  std::string reason;
  GLuint texture = 0;
  if (const auto* left = std::get_if<LeftAlone>(&finding)) {
    reason = left->reason;
    texture = left->texture;
  } else if (std::get<Pipeline>(finding).stack) {
    if (conditional_render) return false;
  } else {
    texture = std::get<Pipeline>(finding).volume.texture;
    reason = why_left(texture);
    if (conditional_render) reason = "the slices are rendered conditionally";
    if (reason.empty() && chain_.group().is_rendered_to(texture))
      reason = "the volume texture is rendered into, or another texture shares its texels";
  }
  if (!reason.empty()) {
    // Slices drawn one by one are still one run: it is counted once a frame.
    const std::uint64_t frame = session_->ledger().frames();
    if (known(texture).left_in_frame != frame) leave(texture, reason);
    known(texture).left_in_frame = frame;
    return false;
  }
  run_ = std::make_unique<Run>(std::get<Pipeline>(finding), calls_);
  chain_.set_phase(Phase::deferring);
  return true;
}

void VolumeUnit::close_run() {
  if (!run_) return;
  std::unique_ptr<Run> run = std::move(run_);
  chain_.set_phase(resting_phase());
  const GLuint texture = run->volume_texture();
  const bool shown = shows(run);
  const FrameShares spent = clock_.take();
  note([&](FrameRecord& frame) { frame.spent_ms += spent; });
  if (shown) count_speed(texture, spent);
  if (!shown) {
    settle_held();
    run->replay(*context().gl);
  }
  chain_.set_phase(resting_phase());
}

bool VolumeUnit::shows(std::unique_ptr<Run>& closed) {
  const Run& run = *closed;
  const TimedShare timed(clock_, &FrameShares::recognition);
  if (run.pipeline().stack && !is_a_stack(run)) {
    inside_begin = run.inside_begin;
    return false;
  }
  const GLuint texture = run.volume_texture();
  if (run.inside_begin) {
    leave(texture, "calls other than vertices between glBegin and glEnd");
    inside_begin = true;
    return false;
  }
  try {
    if (std::string reason = why_left(texture); !reason.empty()) throw Refusal{std::move(reason)};
    substitute(closed);
    return true;
  } catch (const Refusal& refusal) {
    ++known(texture).refusals;
    leave(texture, refusal.reason);
  } catch (const NothingVisible&) {
  } catch (const compositor::RequestRefused& refused) {
    leave(texture, refused.what());
  } catch (const compositor::ServiceLost& lost) {
    const auto lock = session_->lock();
    session_->lost(lost);
    // Said once by whoever started the nodes, or by the session.
    leave(texture, lost.reason(), false);
  } catch (const std::exception& error) {
    leave(texture, error.what());
  }
  return false;
}

Phase VolumeUnit::resting_phase() const {
  if (!merging_->held.empty()) return Phase::deferring;
  return depth_watched_ != 0 ? Phase::depth_deferred : Phase::watching;
}

void VolumeUnit::stack_defined() {
  stacks_possible_ = true;
  frames_without_stack_ = 0;
  if (!stacks_watched_) chain_.group().stacks_watched();
  stacks_watched_ = true;
  if (chain_.phase() == Phase::plain) chain_.set_phase(Phase::watching);
}

void VolumeUnit::leave_stacks() {
  if (!stacks_watched_ || !known_.empty()) return;
  if (stacks_possible_ && ++frames_without_stack_ < most_frames_without_stack) return;
  stop_watching_stacks();
  // The next textures of one size begin a row of their own; one look at what they draw is enough then.
  stack_detection = {};
  other_stacks_ = patient_refusals - 1;
  if (chain_.phase() == Phase::watching && !chain_.group().has_volumes()) chain_.set_phase(Phase::plain);
}

void VolumeUnit::stop_watching_stacks() {
  if (stacks_watched_) chain_.group().stacks_left();
  stacks_watched_ = stacks_possible_ = false;
}

/// Textured quads in a row are no volume until their geometry says so.
bool VolumeUnit::is_a_stack(const Run& run) {
  const std::vector<GLuint> textures = run.slices();
  if (run.inside_begin || textures.size() < fewest_stack_slices) return false;
  if (known_.contains(run.volume_texture())) return true;
  KnownVolume unknown;
  Substitution trial{.run = run, .pipeline = run.pipeline(), .volume = unknown};
  try {
    observe(trial);
    find_geometry(trial);
    other_stacks_ = 0;
    return true;
  } catch (const Refusal&) {
    // Each look costs a drawing in feedback mode: whoever draws other things from many textures is soon left
    // alone.
    if (++other_stacks_ >= patient_refusals) stacks_possible_ = false;
  } catch (const NothingVisible&) {
  }
  return false;
}

const ProgramStages& VolumeUnit::stages(GLuint program, const ProgramRecord& record) {
  auto& [link, stages] = stages_[program];
  if (link != record.link) {
    if (stages.observer != 0) context().gl->DeleteProgram(stages.observer);
    stages = take_apart(context(), record, program);
    link = record.link;
  }
  return stages;
}

void VolumeUnit::observe(Substitution& s) {
  const DispatchTable& gl = *context().gl;
  if (s.pipeline.program != 0) s.fragment.record = chain_.group().programs().program(s.pipeline.program);
  const ProgramRecord* const record = s.fragment.record.get();
  s.fragment.application = s.pipeline.program;
  if (record != nullptr) {
    const ProgramStages& parts = stages(s.pipeline.program, *record);
    s.fragment.inputs = parts.inputs;
    const bool one_draw = s.run.draws == 1 && parts.observer != 0;
    if (!parts.trouble.empty() && !one_draw) throw Refusal{parts.trouble};
    if (record->vertex_shader) {
      if (clips_in_shader(gl)) throw Refusal{"clip planes cut what a vertex shader draws"};
      const std::string known_coordinate = s.volume.march ? s.volume.march->space.input : std::string();
      Capture capture = capture_vertices(context(), s.run, parts, known_coordinate);
      if (!capture.fit && !known_coordinate.empty()) capture = capture_vertices(context(), s.run, parts);
      if (capture.polygons.count() == 0) throw NothingVisible{};
      s.proxy = one_draw && capture.fit && draws_box(context(), s.run, parts, capture);
      if (s.proxy) {
        s.capture = std::move(capture);
        return;
      }
      if (!parts.trouble.empty()) throw Refusal{parts.trouble};
      if (!capture.fit) throw Refusal{"no output of the vertex shader is an affine map of the position"};
      s.polygons = std::move(capture.polygons);
      s.fit = capture.fit;
      if (s.pipeline.stack) {
        s.stack = place_slices(s.run, s.polygons);
        s.fit = fit_camera(s.polygons.vertices);
      }
      s.fragment.coordinate = capture.coordinate;
      s.fragment.first = capture.first;
      s.fragment.last = capture.last;
      s.fragment.range = capture.range;
      s.capture = std::move(capture);
      return;
    }
  } else {
    s.fragment.inputs = {{"gl_TexCoord[0]", GL_FLOAT_VEC4, 4, false},
                         {"gl_FrontColor", GL_FLOAT_VEC4, 4, false}};
    if (s.pipeline.assembly) append_untold_inputs(s.fragment.inputs);
  }
  if (gl.IsEnabled(GL_COLOR_SUM)) throw Refusal{"a secondary colour is added after texturing"};
  GLint colour_control = 0;
  gl.GetIntegerv(GL_LIGHT_MODEL_COLOR_CONTROL, &colour_control);
  if (gl.IsEnabled(GL_LIGHTING) && colour_control == GL_SEPARATE_SPECULAR_COLOR) {
    throw Refusal{"specular colour is added after texturing"};
  }
  s.polygons = observe_by_feedback(context(), s.run);
  if (s.polygons.count() == 0) throw NothingVisible{};
  if (s.pipeline.stack) s.stack = place_slices(s.run, s.polygons);
  if (s.pipeline.fog) {
    s.fog_numbers = eye_distances(gl, s.polygons.vertices);
    s.fragment.inputs.push_back({"gl_FogFragCoord", GL_FLOAT, 1, false});
  }
  if (!s.polygons.constant_colour)
    throw Refusal{"the colour varies over the slices (lighting with a varying normal)"};
  s.fragment.coordinate = "gl_TexCoord[0]";
  for (const StageInput& input : s.fragment.inputs) {
    if (input.name == "gl_TexCoord[0]") {
      s.fragment.first.push_back({});
    } else if (input.name == "gl_FrontColor") {
      s.fragment.first.push_back(s.polygons.primary_colour);
    } else if (s.pipeline.fog && input.name == "gl_FogFragCoord") {
      s.fragment.first.push_back({s.fog_numbers.front(), 0, 0, 0});
    } else if (s.pipeline.assembly) {
      s.fragment.first.push_back({0.25F, 0.25F, 0.25F, 1});
    } else {
      throw Refusal{"the fragment shader reads " + input.name + ", which feedback does not tell"};
    }
  }
  s.fragment.last = s.fragment.first;
  if (s.pipeline.assembly) std::fill(s.fragment.last.begin() + 2, s.fragment.last.end(), untold_value);
  s.fragment.range = {s.fragment.first, s.fragment.first};
  if (s.pipeline.fog) {
    const auto [low, high] = std::minmax_element(s.fog_numbers.begin(), s.fog_numbers.end());
    s.fragment.first.back()[0] = s.fragment.range.low.back()[0] = *low;
    s.fragment.last.back()[0] = s.fragment.range.high.back()[0] = *high;
  }
}

void VolumeUnit::find_geometry(Substitution& s) {
  if (!s.fit) s.fit = fit_camera(s.polygons.vertices);
  if (!s.fit) throw Refusal{"the draw does not span the volume (a single slice or face)"};
  if (s.fit->residual > max_fit_residual)
    throw Refusal{"positions are not an affine map of texture coordinates"};
  if (s.polygons.clipped) {
    s.request.clip_planes = clip_planes_in_texture_space(*context().gl, s.fit->texture_to_clip);
  }
  SliceFinding finding = find_slices(s.polygons, *s.fit, s.request.clip_planes, order_of(s.pipeline));
  if (const auto* reason = std::get_if<std::string>(&finding)) throw Refusal{*reason};
  s.slices = std::get<SliceSet>(finding);
  if (!s.capture || s.pipeline.stack) return;
  s.slice_segments = find_slice_segments(*s.capture, s.polygons.vertices, s.fragment.inputs, s.slices, *s.fit);
  for (const ObservedSegment& observed : s.slice_segments) s.fragment.segment_ends.push_back(observed.input);
}

void VolumeUnit::compose_request(Substitution& s) {
  const DispatchTable& gl = *context().gl;
  volume::RenderRequest& request = s.request;
  std::array<GLint, 4> viewport{};
  gl.GetIntegerv(GL_VIEWPORT, viewport.data());
  request.viewport = {viewport[0], viewport[1], viewport[2], viewport[3]};
  request.window = request.viewport;
  if (gl.IsEnabled(GL_SCISSOR_TEST)) {
    std::array<GLint, 4> scissor{};
    gl.GetIntegerv(GL_SCISSOR_BOX, scissor.data());
    request.window = intersection(request.window, {scissor[0], scissor[1], scissor[2], scissor[3]});
  }
  gl.GetDoublev(GL_DEPTH_RANGE, request.depth_range.data());
  request.volume = s.volume.description.id;
  request.version = s.volume.description.version;
  request.texture_to_clip = s.fit->texture_to_clip;
  request.planes = s.slices.planes;
  request.region = s.slices.region;
  request.op = s.pipeline.blending.op;
  request.filter = s.volume.texture.filter;
}

void VolumeUnit::hide_behind_geometry(Substitution& s) {
  if (!s.pipeline.depth_test) return;
  const TimedShare timed(clock_, &FrameShares::depth);
  s.request.depth = read_depth(context(), s.pipeline.target, volume::footprint(s.request, s.request.region),
                               s.pipeline.depth_or_equal);
  if (!s.request.depth) return;
  // A scene without opaque geometry sends none.
  const std::uint64_t bytes = sizeof(float) * s.request.depth->depth.size();
  const bool absent =
      hides_nothing(*s.request.depth) && !session_->disabled_optimizations(Optimization::absent_depth);
  if (absent) s.request.depth.reset();
  note([&](FrameRecord& frame) {
    Amount& depth = frame.amount(Optimization::absent_depth);
    (absent ? depth.left_out : depth.done) += bytes;
  });
  if (!absent) count_done(Optimization::absent_depth, "opaque geometry stands in the image");
}

void VolumeUnit::substitute(std::unique_ptr<Run>& closed) {
  const Run& run = *closed;
  // Frames may end in other contexts than the one that draws.
  if (const std::uint64_t frame = session_->ledger().frames(); frame != tidied_in_frame_) {
    settle_held();
    find_merged_volumes();
    forget_deleted_volumes();
    tidied_in_frame_ = frame;
  }
  Substitution s{.run = run, .pipeline = run.pipeline(), .volume = known(run.volume_texture())};
  s.texture_version = chain_.group().texture_version(s.pipeline.volume.texture);
  observe(s);
  if (!s.proxy) find_geometry(s);
  for (const GLuint texture : s.stack) {
    if (chain_.group().is_rendered_to(texture)) throw Refusal{"a texture of the stack is rendered into"};
    // Any two stacks, and any two states of one, differ in the mixture.
    constexpr std::uint64_t prime = 0x100000001b3;
    s.texture_version = (s.texture_version * prime) ^ texture;
    s.texture_version = (s.texture_version * prime) ^ chain_.group().texture_version(texture);
  }
  if (holds(closed, s)) return;
  settle_held();
  const auto lock = session_->lock();
  compositor::RenderService& service = session_->service();
  process_counters().nodes = service.nodes();
  if (s.proxy) {
    compose_proxy_request(s, service);
  } else {
    upload(s, service);
    classify(s);
    compose_request(s);
    hide_behind_geometry(s);
  }
  if (auto* const table = std::get_if<volume::TransferFunction>(&s.request.classification);
      table != nullptr && s.volume.sample_rounding.rounds())
    *table = with_rounded_samples(*table);
  s.volume.verification.begin(s.inputs, volume::footprint(s.request, s.request.region).pixels());
  const volume::FrameCounts counts =
      show(service, s, [&](const volume::ImageView& image) { verify(s, image); });
  settle_depth(s);
  if (s.volume.frames == 0 || session_->options().explain) explain(s);
  ++s.volume.frames;
  note_brick(s);
  count_substituted(s.volume, counts);
}

void VolumeUnit::count_substituted(KnownVolume& known, const volume::FrameCounts& counts) {
  known.refusals = 0;
  known.counters->draws_substituted.fetch_add(1, std::memory_order_relaxed);
  note([&](FrameRecord& frame) {
    ++frame.substituted;
    frame.counts += counts;
  });
}

void VolumeUnit::settle_depth(const Substitution& s) {
  if (!s.pipeline.depth_test || !s.pipeline.depth_write) return;
  const std::string_view why = s.volume.frames == 0       ? "the first of the volume"
                               : s.volume.depth_looked_at ? "somebody looked at it"
                               : session_->disabled_optimizations(Optimization::unseen_depth) ? "asked to"
                                                                                              : "";
  note([&](FrameRecord& frame) {
    Amount& runs = frame.amount(Optimization::unseen_depth);
    ++(why.empty() ? runs.left_out : runs.done);
  });
  if (!why.empty()) {
    write_depth(*context().gl, s.run);
    count_done(Optimization::unseen_depth, why);
  }
  if (s.volume.depth_looked_at) return;
  depth_watched_ = s.run.volume_texture();
  chain_.set_phase(Phase::depth_deferred);
}

void VolumeUnit::depth_looked_at() {
  if (const auto watched = known_.find(depth_watched_); watched != known_.end())
    watched->second.depth_looked_at = true;
  depth_cleared();
}

void VolumeUnit::depth_cleared() {
  depth_watched_ = 0;
  chain_.set_phase(Phase::watching);
}

void VolumeUnit::frame_ended(FrameEnd kind) {
  if (kind != FrameEnd::swap && kind != FrameEnd::finish) return;
  // After a swap the depth buffer's contents are undefined; without one they lie in memory that the application
  // may look at without a call.
  if (depth_watched_ != 0) {
    if (kind == FrameEnd::swap) {
      depth_cleared();
    } else {
      depth_looked_at();
    }
  }
  FrameRecord frame = session_->ledger().close(this);
  frame.time_ms = milliseconds_since(frame_started_);
  count_frame(frame);
  if (session_->options().explain && frame.substituted > 0)
    fmt::print(stderr, "understudy: frame {}: {:.4g} ms; left out: {}\n", process_counters().frames.load(),
               frame.time_ms, sentence_of(frame));
  frame_started_ = Clock::now();
  forget_deleted_volumes();
  leave_stacks();
}

void VolumeUnit::forget_deleted_volumes() {
  forget_deleted_bricks();
  std::erase_if(known_, [&](auto& entry) {
    auto& [texture, volume] = entry;
    if (chain_.group().remembers(texture)) return false;
    if (volume.counters != nullptr) leave_behind(*volume.counters);
    if (volume.generation != 0) {
      const auto lock = session_->lock();
      if (volume.generation == session_->generation()) session_->forget(volume.description.id);
    }
    return true;
  });
}

void VolumeUnit::abandon() {
  run_.reset();
  stop_watching_stacks();
  stages_.clear();
  for (auto& [texture, volume] : known_) {
    if (volume.counters != nullptr) leave_behind(*volume.counters);
    const auto lock = session_->lock();
    if (volume.generation != 0 && volume.generation == session_->generation())
      session_->forget(volume.description.id);
  }
  known_.clear();
  for (const auto& merged : merging_->volumes) {
    const auto lock = session_->lock();
    if (merged->volume.generation != 0 && merged->volume.generation == session_->generation())
      session_->forget(merged->volume.description.id);
  }
  merging_ = std::make_unique<Merging>();
}

}  // namespace understudy::spu
