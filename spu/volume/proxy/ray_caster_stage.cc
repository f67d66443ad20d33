// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/ray_caster_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <limits>
#include <utility>

#include "compositor/blend.h"
#include "compositor/rendered.h"
#include "compositor/service.h"
#include "compositor/service/limits.h"
#include "spu/report/optimization.h"
#include "spu/state_value.h"
#include "spu/volume/classification/texel_inputs.h"
#include "spu/volume/proxy/exit_steps.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/geometry_inside.h"
#include "spu/volume/proxy/march_changes.h"
#include "spu/volume/proxy/ray_ends.h"
#include "spu/volume/proxy/shader_background.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/texture/value_range.h"
#include "spu/volume/timing/frame_account.h"
#include "spu/volume/verification/tile_comparison.h"
#include "volume/cell_lattice.h"
#include "volume/footprint.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::spu {
namespace {

/// Ghost layer of bricks for light, in cells: one block, the farthest that recognised gradients reach.
constexpr int gradient_ghost_layer = 8;

/// Returns the draw's box in a space that is known. Throws Refusal if its surface is not closed.
ProxyBox box_in(const MarchContext& measured, const CoordinateSpace& space) {
  const auto box = proxy_box(measured, space);
  if (!box)
    throw Refusal{"the near plane cuts the ray caster's box, or the eye is inside",
                  {},
                  "move the eye out of the volume, or the near plane closer to the eye"};
  return *box;
}

/// Returns the one of the image's nine parts that shows something in most pixels: enough to compare marches by.
NativeImage fullest_part(const NativeImage& whole) {
  const volume::Rect& all = whole.rect;
  const int columns = std::max(1, all.width / 3);
  const int rows = std::max(1, all.height / 3);
  NativeImage fullest;
  std::size_t most = 0;
  for (int y = 0; y + rows <= all.height; y += rows) {
    for (int x = 0; x + columns <= all.width; x += columns) {
      NativeImage part{{all.x + x, all.y + y, columns, rows}, {}};
      part.rgba.reserve(4 * part.rect.pixels());
      std::size_t visible = 0;
      for (int row = y; row < y + rows; ++row) {
        const auto from = whole.rgba.begin() + 4 * (std::ptrdiff_t(row) * all.width + x);
        for (auto pixel = from; pixel < from + 4 * std::ptrdiff_t(columns); pixel += 4)
          visible += pixel[3] > 0 ? 1 : 0;
        part.rgba.insert(part.rgba.end(), from, from + 4 * std::ptrdiff_t(columns));
      }
      if (visible <= most && !fullest.rgba.empty()) continue;
      most = visible;
      fullest = std::move(part);
    }
  }
  return fullest;
}

/// Returns the planes at which rays begin and end.
std::vector<volume::HalfSpace> ends_of(const ProxyBox& box, const Cuts& cuts) {
  std::vector<volume::HalfSpace> planes = box.cuts;
  planes.insert(planes.end(), cuts.clipping.begin(), cuts.clipping.end());
  return planes;
}

/// `follows`: which of the varying scalars move with the camera; one that changes alone may cut the volume.
VerificationSchedule::Inputs inputs_of(const MarchInputs& inputs, const March& march, const SentVolume& sent,
                                       const std::vector<bool>& follows) {
  using Effect = VerificationSchedule::Effect;
  const auto on_samples = [&](Effect foreseen) {
    return effect_on_samples(sent.texture, sent.range, probed_entries_of_rays, foreseen);
  };
  VerificationSchedule::Inputs all;
  append_texels(sent.description.version, on_samples(Effect::measured), all);
  const std::size_t first = all.size();
  for (const float value : inputs.fixed) all.push_back({value});
  for (const std::size_t table : inputs.tables) all[first + table].effect = on_samples(Effect::predicted);
  // Steps that were only likely are probably other ones now.
  for (const std::size_t step : inputs.steps)
    all[first + step].effect = march.steps_seen ? Effect::predicted : Effect::unknown;
  std::size_t vector = 0;
  for (std::size_t i = 0; i < inputs.varying.size(); ++i) {
    while (vector + 1 < inputs.varying_begins.size() && inputs.varying_begins[vector + 1] <= i) ++vector;
    const Effect alone = inputs.varying_chooses[vector] ? Effect::decides : Effect::unknown;
    // NaN: the depth of opaque geometry, which is drawn in every frame.
    const float value = inputs.varying[i];
    all.push_back({std::isnan(value) ? 0.0F : value, follows[i] ? Effect::followed : alone});
  }
  for (const float value : inputs.depths) all.push_back({value});
  // That the program cuts at these planes is proved by images that are right after they have moved.
  for (const float value : inputs.cuts) all.push_back({value, Effect::measured});
  // NaN equals no earlier value, so this counts as a change every time.
  if (inputs.unreadable) all.push_back({std::numeric_limits<float>::quiet_NaN(), Effect::unknown});
  return all;
}

/// RaysLookedAt::offset of a frame: among many frames, no two come close to each other.
double offset_of_values(std::uint64_t frame) {
  constexpr double golden_section = 0.618033988749895;
  const double turns = double(frame) * golden_section;
  return turns - std::floor(turns);
}

/// What to probe when the camera has moved, as in every frame while somebody turns a volume: values, a long ray
/// and light in turn, with other values each time. If a step may have changed, always a long ray: short ones
/// have as many samples under a step that is a little longer.
RaysLookedAt rays_looked_at(const March& march, bool turned, BesideChange beside, std::uint64_t frame) {
  if (!turned || beside == BesideChange::alone) return {};
  const std::uint64_t turn = frame % (march.light ? 3 : 2);
  const bool values = turn == 0 || (march.shows_one_colour() && !march.light);
  return {.values = values ? 3 : 0,
          .offset = offset_of_values(frame),
          .long_ray = turn == 1 || beside == BesideChange::with_camera,
          .light = turn == 2};
}

/// What to check when steps have another length, as in many frames while somebody turns a volume in VTK, and
/// nothing else is known to be new: the positions of samples, and in turn with them, of a march with light, how
/// far gradients reach, along another axis each time. `derived`: how often there were other lengths.
PlacesLookedAt few_places(const March& march, std::uint64_t derived) {
  PlacesLookedAt few{.values = 8,
                     .predicted = true,
                     .bands = {.columns_of_middle = 32, .height_of_middle = offset_of_values(derived)},
                     .axes_of_gradients = {}};
  if (march.light && derived % 2 != 0) {
    few.samples = false;
    few.axes_of_gradients = {std::size_t(derived / 2 % 3)};
  }
  return few;
}

/// Appends the march as the last one measured.
void remember(MeasuredMarch march, std::vector<MeasuredMarch>& measured) {
  constexpr std::size_t most_remembered = 4;  // two boxes of one program, each with and without a setting
  if (measured.size() == most_remembered) measured.erase(measured.begin());
  measured.push_back(std::move(march));
}

/// Returns the path through the middle of the view; null if the eye is inside.
std::optional<volume::Vec3> middle_way(const ProxyBox& box) {
  if (!box.cuts.empty()) return std::nullopt;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const auto middle = rays.middle();
  return rays.way(middle[0], middle[1]);
}

/// Whether this view shows which of several steps, left open by an earlier one, are the march's.
bool tells_steps_apart(const March& march, const ProxyBox& box) {
  const auto way = middle_way(box);
  return way && tells_apart(march.alike_metrics, march.steps, *way);
}

/// Stores the path of a view that leaves open what the march's steps are.
void remember_way(const March& march, const ProxyBox& box, std::vector<MeasuredWay>& ways) {
  constexpr std::size_t most_remembered = 4;
  if (!count_as_measured(march.steps.metric, ways)) ways.clear();
  const auto way = middle_way(box);
  if (!way || march.alike_metrics.size() < 2) return;
  if (ways.size() == most_remembered) ways.erase(ways.begin());
  ways.push_back({*way, steps_of_way(march.steps, *way)});
}

/// How badly a march explains an image; smaller is better. First by its worst tile, as verification judges it.
/// If that is no more than a driver's rounding, steps that were measured precede those that were guessed; then
/// the mean decides, in which a few rays that graze the box weigh much.
struct Unlikeness {
  static constexpr double rounding = 0.25;

  Unlikeness() = default;
  Unlikeness(const March& march, const ImageDifference& difference)
      : severity(std::max(difference.worst.severity(), rounding)),
        guessed(!march.steps_seen),
        mean_square(difference.mean_square) {}
  auto operator<=>(const Unlikeness&) const = default;  // NOLINT(modernize-use-nullptr): there is no pointer

  double severity = 0;
  bool guessed = false;
  double mean_square = 0;
};

/// Whether the program, with its present uniforms, fetches from a depth texture.
bool fetches_depth(const GlContext& context, const Pipeline& pipeline, const program::StageFacts& facts) {
  const DispatchTable& gl = *context.gl;
  return std::ranges::any_of(pipeline.others, [&](const SampledTexture& texture) {
    if (!is_depth_texture(gl, texture)) return false;
    return std::ranges::any_of(facts.fetches, [&](const program::Fetch& fetch) {
      return may_be_sampled_by(gl, pipeline.program, fetch.sampler, texture);
    });
  });
}

/// Why fragments that replace what is there may leave another image than the nodes'; null if they leave the
/// same.
std::optional<Refusal> refusal_of_replacing(const GlContext& context, const Pipeline& pipeline,
                                            const ProgramFindings& says) {
  // Where both faces are drawn, the nearer fragment must remain.
  const bool nearest_is_left =
      context.gl->IsEnabled(GL_CULL_FACE) || (pipeline.depth_test && pipeline.depth_write);
  const bool blends = !pipeline.blending.replaces;
  if (!nearest_is_left) {
    return blends ? "front and back faces of the box are drawn, and both are opaque"
                  : "front and back faces of the box are drawn, and blending is disabled";
  }
  if (!says.facts.discards.empty()) {
    return blends ? "fragments are discarded, and the others are opaque"
                  : "fragments are discarded, and blending is disabled";
  }
  if (blends && !context.core && context.gl->IsEnabled(GL_ALPHA_TEST))
    return "an alpha test is enabled, and fragments are opaque";
  return std::nullopt;
}

/// Whether the alpha test discards rays other than those of opacity 0.
bool discards_visible_alpha(const DispatchTable& gl) {
  GLfloat reference = 0;
  gl.GetFloatv(GL_ALPHA_TEST_REF, &reference);
  switch (state_value(gl, GL_ALPHA_TEST_FUNC)) {
    case GL_GREATER:
    case GL_GEQUAL:
    case GL_NOTEQUAL:
      return reference > 0;
    default:
      return true;
  }
}

/// Whether rays of opacity 0 may change what they are blended with.
bool shows_rays_without_opacity(const Blending& blending, const March& march) {
  using volume::Operator;
  constexpr float rounding = 1e-5F;
  if (blending.op == Operator::min || (!blending.alpha.untouched && blending.alpha.op == Operator::min))
    return true;
  return blending.premultiplied && std::ranges::any_of(march.table.entries, [](const volume::Rgba& entry) {
           return entry[3] == 0 && std::max({entry[0], entry[1], entry[2]}) > rounding;
         });
}

/// Why the alpha test may discard rays that would change the image, which is made without it; null if it
/// cannot.
std::optional<Refusal> refusal_of_alpha_test(const GlContext& context, const Pipeline& pipeline,
                                             const March& march) {
  const DispatchTable& gl = *context.gl;
  if (context.core || !gl.IsEnabled(GL_ALPHA_TEST) || state_value(gl, GL_ALPHA_TEST_FUNC) == GL_ALWAYS)
    return std::nullopt;
  if (discards_visible_alpha(gl))
    return Refusal{"the alpha test discards rays that would be visible", {}, "turn the alpha test off"};
  if (shows_rays_without_opacity(pipeline.blending, march))
    return Refusal{
        "the alpha test discards rays of opacity 0 that have colours", {}, "turn the alpha test off"};
  return std::nullopt;
}

bool shows_something(const volume::Image& image) {
  constexpr float least_visible = 0.5F / 255;
  for (std::size_t alpha = 3; alpha < image.rgba.size(); alpha += 4) {
    if (image.rgba[alpha] > least_visible) return true;
  }
  return false;
}

/// Whether the application's fragments, and so the image, replace what is there.
bool replaces_pixels(const Pipeline& pipeline, const March& march) {
  return pipeline.blending.replaces || march.background;
}

/// Whether the box is drawn again to blend its image: it covers some samples of a pixel, and is hidden in some.
/// If its back faces are drawn as well, the image holds what both fragments leave, and blending two would be
/// too many.
bool covers_samples(const GlContext& context, const Pipeline& pipeline, const March& march) {
  const Blending& blending = pipeline.blending;
  return pipeline.target.samples > 0 && !replaces_pixels(pipeline, march) &&
         blending.front_to_back == FrontToBack::no && !blending.alpha_stands_apart() &&
         blending.op != volume::Operator::min && context.gl->IsEnabled(GL_CULL_FACE);
}

/// Whether a region is the whole texture, up to rounding: a box that is cropped by less than a texel has other
/// coordinates, too, while samples that are counted ahead may begin half a texel inside
/// (volume::is_all_of_texture).
bool is_whole_texture(const volume::Box& region) {
  constexpr double same = 1e-3;
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(region.low[k]) > same || std::abs(region.high[k] - 1) > same) return false;
  }
  return true;
}

Refusal no_coordinate() {
  return "no output of the vertex shader is a texture coordinate over the whole box";
}

}  // namespace

/// One draw of a box, on its way through this stage.
struct RayCasterStage::Draw {
  const GlContext& context;
  const Run& run;
  const RecognisedRun& seen;
  const ProgramStages& stages;
  KnownRayCaster known;
  ProbeSurfaces& surfaces;
  std::vector<CoordinateSpace> spaces{};
  Cuts cuts{};
  bool eye_inside = false;
  bool ends_at_geometry = false;                           ///< as in MarchContext
  std::optional<program::NeighbourDistance> neighbours{};  ///< likewise
  bool samples_move_samples = false;                       ///< as in program_check.h
  std::span<const std::string> tables_of_samples{};
  std::span<const std::string> tables_of_one_texel{};
  std::span<const std::string> tables_of_gradients{};
  std::optional<volume::Rect> kept{};  ///< part of the window with fragments, if some are discarded by position

  MarchContext measured() const {
    return {context,
            run,
            stages,
            known.sent.texture,
            surfaces,
            known.sent.range,
            !cuts.clipping.empty(),
            ends_at_geometry,
            kept,
            neighbours,
            tables_of_one_texel,
            tables_of_gradients,
            known.march.ways,
            &*seen.capture};
  }
};

ProxyBox RayCasterStage::find_box(Draw& draw) {
  std::optional<March>& march = draw.known.march.march;
  if (march) {
    draw.spaces = {march->space};
  } else {
    draw.spaces = spaces_of(draw);
    if (draw.spaces.empty()) throw no_coordinate();
  }
  ProxyBox box = box_in(draw.measured(), draw.spaces.front());
  if (march && march->space.of_whole_box && !is_whole_texture(box.region)) {
    march.reset();
    ++draw.known.march.box_changes;
    throw Refusal{"the coordinates of the ray caster's box change while its volume stays",
                  fmt::format("'{}' was measured where the box was another", draw.spaces.front().input),
                  "nothing: which part of the volume is in the box is known of texture coordinates alone"};
  }
  if (march && march->steps.counted_from &&
      !volume::is_all_of_texture(box.region, draw.measured().texture.size)) {
    march.reset();
    throw Refusal{"a part of the volume is in a box whose samples are counted before they are taken"};
  }
  if (!box.cuts.empty() && !draw.known.verified.left_inside.empty())
    throw Refusal{draw.known.verified.left_inside};
  draw.cuts = read_cuts(context_, draw.run.pipeline().program, box.camera.texture_to_clip);
  if (march && march->clipped == draw.cuts.clipping.empty()) march.reset();
  return box;
}

std::vector<CoordinateSpace> RayCasterStage::spaces_of(const Draw& draw) {
  constexpr int most_box_changes = 3;
  std::vector<CoordinateSpace> spaces = coordinate_spaces(draw.measured());
  // A box that keeps changing moves with the eye, or shows one part of the volume after the other.
  if (draw.known.march.box_changes > most_box_changes) std::erase_if(spaces, &CoordinateSpace::of_whole_box);
  return spaces;
}

volume::Box RayCasterStage::region_in_any(const Draw& draw, const ProxyBox& box) {
  volume::Box region = box.region;
  for (std::size_t i = 1; i < draw.spaces.size(); ++i) {
    const auto other = proxy_box(draw.measured(), draw.spaces[i]);
    for (std::size_t k = 0; k < 3 && other; ++k) {
      region.low[k] = std::min(region.low[k], other->region.low[k]);
      region.high[k] = std::max(region.high[k], other->region.high[k]);
    }
  }
  return region;
}

void RayCasterStage::follow_inside(Draw& draw, const ProxyBox& box, const MarchInputs& inputs) {
  std::optional<March>& march = draw.known.march.march;
  if (!march || march->from_inside || box.cuts.empty() || inputs.fixed != draw.known.march.inputs.fixed) return;
  // Rays now have all directions, and may show that the step was not known in every one.
  auto again = with_new_steps(draw.measured(), *march, box);
  if (const auto* refusal = std::get_if<Refusal>(&again)) throw *refusal;
  march = std::get<March>(std::move(again));
  std::vector<MeasuredMarch>& measured = draw.known.march.measured;
  if (!measured.empty() && measured.back().inputs.fixed == inputs.fixed) measured.back().march = *march;
}

void RayCasterStage::refuse_again(const Draw& draw) const {
  const RefusalHistory& refusals = draw.known.refusals;
  if (refusals.in_a_row >= patient_refusals && account_.frames() % refused_retry_frames != 0)
    throw Refusal{refusals.last_reason};
}

void RayCasterStage::wait_for_earlier_drawing() const {
  // Otherwise the first probe that is read back would wait for it, and the time of a probe could not be
  // measured.
  const TimedShare timed(account_.clock(), &FrameShares::waiting);
  context_.gl->Finish();
}

std::string_view RayCasterStage::why_measured(const Draw& draw, const ProxyBox& box, const MarchInputs& inputs,
                                              const std::vector<bool>& follows, bool turned) const {
  const KnownMarch& known = draw.known.march;
  if (!known.march) return "the first of the volume";
  const BesideChange beside = change_beside_fragment_stage(known.inputs, inputs, follows);
  const bool same = same_in_fragment_stage(known.inputs, inputs) && beside == BesideChange::none;
  if (!same) wait_for_earlier_drawing();
  const bool holds = same || (inputs.fixed == known.inputs.fixed &&
                              still_marches(draw.measured(), *known.march, box,
                                            rays_looked_at(*known.march, turned, beside, account_.frames())));
  if (!holds) return "tables, uniforms or state that colours depend on changed";
  return session_.disabled_optimizations(Optimization::known_colours) ? "asked to" : "";
}

std::optional<March> RayCasterStage::with_other_steps(const Draw& draw, const ProxyBox& box,
                                                      const MarchInputs& inputs,
                                                      std::span<const TableContents> tables) const {
  const KnownMarch& known = draw.known.march;
  // If neither steps nor tables differ, something else is new.
  if (!known.march || known.measured.empty() || inputs.fixed == known.inputs.fixed) return std::nullopt;
  const MeasuredMarch& base = known.measured.back();
  if (base.march.from_inside != known.march->from_inside || base.march.clipped != known.march->clipped)
    return std::nullopt;
  for (const double factor : step_factors(base.inputs, inputs)) {
    // A table that was edited is measured value by value.
    if (!only_corrected(base.tables, tables, factor)) continue;
    auto derived =
        with_longer_steps(draw.measured(), base.march, box, factor, offset_of_values(account_.frames()));
    if (derived) return derived;
  }
  return std::nullopt;
}

std::optional<March> RayCasterStage::measured_before(const Draw& draw, const ProxyBox& box,
                                                     const MarchInputs& inputs) const {
  KnownMarch& known = draw.known.march;
  if (!known.march || session_.disabled_optimizations(Optimization::known_colours)) return std::nullopt;
  const auto before = std::ranges::find_if(known.measured, [&](const MeasuredMarch& one) {
    return one.inputs.fixed == inputs.fixed && one.march.space == known.march->space &&
           one.march.clipped == known.march->clipped && one.march.from_inside == known.march->from_inside &&
           still_marches(draw.measured(), one.march, box, {});
  });
  if (before == known.measured.end()) return std::nullopt;
  std::rotate(before, before + 1, known.measured.end());
  return known.measured.back().march;
}

ProxyBox RayCasterStage::measure(Draw& draw, const ProxyBox& box, const MarchInputs& inputs,
                                 compositor::RenderService& service) {
  // The table keeps changing while somebody edits it; where samples lie is not measured again for that.
  KnownMarch& known = draw.known.march;
  std::optional<March>& march = known.march;
  if (auto before = measured_before(draw, box, inputs)) {
    march = std::move(before);
    return box;
  }
  std::vector<TableContents> tables = table_contents(context_, draw.run, draw.tables_of_samples);
  std::optional<March> again = with_other_steps(draw, box, inputs, tables);
  const bool derived = again.has_value();
  if (derived) ++known.derived;
  // Constant fields, by which a table is measured, do not show the step of an extreme or a mean.
  const bool step_unknown = march && march->shows_one_colour() && steps_differ(known.inputs, inputs);
  if (march && !again && !step_unknown && !draw.samples_move_samples)
    again = with_new_table(draw.measured(), *march, box);
  // Counts of samples do not show noise that was turned on.
  if (again && !only_tables_differ(known.inputs, inputs) &&
      !still_placed(draw.measured(), *again, box,
                    derived ? few_places(*again, known.derived) : PlacesLookedAt{}))
    again.reset();
  march = again;
  if (!again) {
    refuse_again(draw);
    draw.spaces = spaces_of(draw);
    if (draw.spaces.empty()) throw no_coordinate();
    MarchFinding finding = measure_march(draw.measured(), draw.spaces);
    if (const auto* refusal = std::get_if<Refusal>(&finding)) throw *refusal;
    march = choose_march(draw, service, std::get<std::vector<March>>(finding));
    draw.known.frames = 0;  // verified again, as a new volume is
  }
  if (!again || !derived) remember({*march, inputs, std::move(tables)}, known.measured);
  ProxyBox found = box_in(draw.measured(), march->space);
  if (!again) remember_way(*march, found, known.ways);
  draw.cuts = read_cuts(context_, draw.run.pipeline().program, found.camera.texture_to_clip);
  return found;
}

RayCasterRequest RayCasterStage::request(const Run& run, const RecognisedRun& seen, KnownRayCaster known,
                                         compositor::RenderService& service) {
  const Pipeline& pipeline = run.pipeline();
  Draw draw{context_, run, seen, programs_.stages(pipeline.program), known, surfaces_};
  known.sent.texture = uploader_.describe(pipeline, 0);
  count_texture(known.counters, known.sent.texture);
  const auto values = fragment_uniform_values(context_, pipeline.program, draw.stages);
  const ProgramFindings& says = programs_.findings(pipeline, values, Subject::ray_caster);
  if (auto refusal = refusal_of_ray_caster(says)) throw Refusal{std::move(*refusal)};
  if (pipeline.blending.replaces) {
    if (auto refusal = refusal_of_replacing(context_, pipeline, says)) throw Refusal{std::move(*refusal)};
  }
  draw.ends_at_geometry = fetches_depth(context_, pipeline, says.facts);
  draw.samples_move_samples = samples_move_samples(says);
  draw.tables_of_samples = says.ray->tables_of_samples;
  draw.tables_of_one_texel = says.ray->tables_of_one_texel;
  draw.neighbours = neighbours_of_gradients(says);
  if (draw.neighbours) draw.tables_of_gradients = says.ray->tables_of_gradients;
  ProxyBox box = find_box(draw);
  draw.eye_inside = !box.cuts.empty();
  // Also determines the range of values.
  uploader_.upload({pipeline,
                    {},
                    seen.texture_version,
                    region_in_any(draw, box),
                    {},
                    draw.neighbours ? gradient_ghost_layer : 0},
                   known.sent, known.counters, service);

  MarchInputs inputs = march_inputs(draw.measured(), draw.spaces.front(), group_, says);
  const bool turned = known.march.camera != box.camera.texture_to_clip;
  using Camera = CameraFollowers::Camera;
  const Camera camera = !turned                                                    ? Camera::stayed
                        : known.march.earlier_camera == box.camera.texture_to_clip ? Camera::came_back
                                                                                   : Camera::moved_on;
  known.march.earlier_camera = std::exchange(known.march.camera, box.camera.texture_to_clip);
  if (says.ray->discards_by_place) draw.kept = kept_window(draw, box, inputs, says);
  follow_inside(draw, box, inputs);
  if (turned && known.march.march && tells_steps_apart(*known.march.march, box)) {
    known.march.march.reset();
    known.march.measured.clear();
  }
  const std::vector<bool> follows = known.march.followers.look(known.march.inputs, inputs, camera);
  const std::string_view why = why_measured(draw, box, inputs, follows, turned);
  classifier_.count_probe(why);
  if (!why.empty()) box = measure(draw, box, inputs, service);
  if (auto refusal = refusal_of_alpha_test(context_, pipeline, *known.march.march))
    throw Refusal{std::move(*refusal)};
  VerificationSchedule::Inputs depends_on = inputs_of(inputs, *known.march.march, known.sent, follows);
  known.march.inputs = std::move(inputs);
  if (const auto& background = known.march.march->background) {
    if (!hides_what_was_there(pipeline, background->alpha))
      throw Refusal{"the shader's background is blended with what is there"};
    if (auto refusal = refusal_of_replacing(context_, pipeline, says)) throw Refusal{std::move(*refusal)};
  }
  RayCasterRequest asked{ask(draw, *known.march.march, box, compose(draw, *known.march.march, box)),
                         box.camera};
  asked.image.inputs = std::move(depends_on);
  // How a ray ends at a plane shows in few pixels, and in some views in none.
  asked.image.unproven = known.frames == 0 && known.march.march->clipped;
  if (draw.kept) {
    asked.image.uncut_window = asked.image.request.window;
    asked.image.request.window = intersection(asked.image.request.window, *draw.kept);
  }
  return asked;
}

volume::Rect RayCasterStage::kept_window(const Draw& draw, const ProxyBox& box, const MarchInputs& inputs,
                                         const ProgramFindings& says) const {
  constexpr std::size_t most_kept = 4;  // a window, an image that is saved of it, and so on
  std::array<GLint, 4> viewport{};
  context_.gl->GetIntegerv(GL_VIEWPORT, viewport.data());
  KeptWindow asked{{viewport[0], viewport[1], viewport[2], viewport[3]},
                   discard_inputs(draw.measured(), group_, inputs, says),
                   {}};
  std::vector<KeptWindow>& known = draw.known.march.kept;
  for (const KeptWindow& window : known) {
    if (window.viewport == asked.viewport && window.depends == asked.depends) return window.kept;
  }
  refuse_again(draw);
  const auto finding = kept_rect(draw.measured(), box);
  if (const auto* refusal = std::get_if<Refusal>(&finding)) throw Refusal{*refusal};
  asked.kept = std::get<volume::Rect>(finding);
  if (known.size() == most_kept) known.erase(known.begin());
  known.push_back(std::move(asked));
  return known.back().kept;
}

volume::RenderRequest RayCasterStage::compose(const Draw& draw, const March& march, const ProxyBox& box) {
  const Pipeline& pipeline = draw.run.pipeline();
  const SentVolume& sent = draw.known.sent;
  volume::RenderRequest request =
      composer_.compose(pipeline, box.camera, box.region, sent.description, sent.texture.filter);
  // If the image replaces pixels, the box that it is drawn with is depth-tested itself.
  if (replaces_pixels(pipeline, march) && !draw.ends_at_geometry) return request;
  composer_.hide_behind_geometry(pipeline, request);
  const volume::Matrix4& texture_to_clip = box.camera.texture_to_clip;
  if (!draw.ends_at_geometry &&
      geometry_inside(request, texture_to_clip, {texture_to_clip, box.region, box.cuts}))
    throw Refusal{"opaque geometry stands in the ray caster's box, and rays do not end at it"};
  // Of a multisampled pixel, some samples may be hidden, and others not.
  if (covers_samples(context_, pipeline, march) && !draw.ends_at_geometry) request.depth.reset();
  return request;
}

ImageRequest RayCasterStage::ask(const Draw& draw, const March& march, const ProxyBox& box,
                                 volume::RenderRequest composed) const {
  ImageRequest image;
  image.request = std::move(composed);
  image.ray_caster = true;
  image.replaces_pixels = replaces_pixels(draw.run.pipeline(), march);
  image.covers_samples = covers_samples(context_, draw.run.pipeline(), march);
  if (march.background) image.no_ray = over_background(*march.background, {});
  image.eye_inside = draw.eye_inside;
  image.opaque = image.request.depth;
  image.parts = draw.cuts.parts;
  image.ray_ends = ends_of(box, draw.cuts);
  ask_nodes(march, image.request);
  image.request.clip_planes = image.parts.front();
  if (!image.ray_ends.empty() && march.steps.divided)
    throw Refusal{"planes cut a ray caster's box whose rays are divided evenly"};
  const bool cut = !image.ray_ends.empty() || !image.parts.front().empty();
  if (cut && march.steps.counted_from)
    throw Refusal{"planes cut a ray caster's box whose samples are counted before they are taken"};
  // Then rays too short for a sample have none.
  if (cut || !volume::is_all_of_texture(image.request.region, draw.measured().texture.size))
    image.request.steps->at_least_one = false;
  // One scalar per pixel is sent to the nodes.
  const std::size_t pixels = volume::footprint(image.request, image.request.region).pixels();
  const auto refuse_more = [&](const char* reason) {
    if (pixels > std::size_t(compositor::limits::max_ray_offsets))
      throw Refusal{reason, fmt::format("{} pixels, {} are taken", pixels, compositor::limits::max_ray_offsets),
                    "make the window smaller"};
  };
  if (march.from_exit) {
    if (cut) throw Refusal{"planes cut a ray caster's box whose rays begin at its back"};
    if (draw.ends_at_geometry) throw Refusal{"rays that begin at the back of the box end at opaque geometry"};
    refuse_more("rays begin at the back of the box in more pixels than may start separately");
    const volume::RenderRequest& request = image.request;
    image.request.steps = counted_from_exit(march.steps, {request.texture_to_clip, request.region},
                                            request.viewport, volume::footprint(request, request.region));
  }
  if (!image.ray_ends.empty())
    refuse_more("planes cut a ray caster's box in more pixels than rays may start in separately");
  end_rays_at(image.ray_ends, march.past_planes, image.request);
  return image;
}

void RayCasterStage::complete_image(const March& march, ImageRequest& asked, compositor::RenderService& service,
                                    volume::Image& image, volume::FrameCounts& counts) {
  volume::RenderRequest& request = asked.request;
  // The nodes' image omits the rim that shows nothing.
  volume::Image whole(volume::footprint(request, request.region));
  std::fill(whole.rgba.begin(), whole.rgba.end(), volume::neutral_value(request.op));
  compositor::blend(request.op, whole, image.view());
  image = std::move(whole);
  for (std::size_t part = 1; part < asked.parts.size(); ++part) {
    request.clip_planes = asked.parts[part];
    const TimedShare timed(account_.clock(), &FrameShares::render);
    const compositor::Rendered rendered = service.render(request);
    compositor::blend(request.op, image, rendered.image);
    counts += rendered.counts;
  }
  request.depth = asked.opaque;
  if (needs_finish(march)) finish_image(march, image);
  if (march.shortest_alpha) cover_entered(asked.ray_ends, request, *march.shortest_alpha, image);
  if (!march.background) return;
  asked.background_alone = !shows_something(image);
  fill_behind_entered(asked.ray_ends, request, *march.background, image);
}

March RayCasterStage::choose_march(Draw& draw, compositor::RenderService& service,
                                   const std::vector<March>& marches) {
  std::optional<NativeImage> looked_at;
  const March* best = nullptr;
  Unlikeness least;
  for (const March& march : marches) {
    const auto box = proxy_box(draw.measured(), march.space);
    if (!box) continue;
    volume::RenderRequest composed = compose(draw, march, *box);
    if (!looked_at) {
      const auto drawn =
          native_image(context_, draw.run, composed,
                       comparable(volume::footprint(composed, composed.region), composed.viewport));
      if (!drawn) break;
      looked_at = fullest_part(*drawn);
    }
    composed.window = intersection(composed.window, looked_at->rect);
    if (draw.kept) composed.window = intersection(composed.window, *draw.kept);
    ImageRequest image = ask(draw, march, *box, std::move(composed));
    image.request.exact = true;  // it is compared
    const compositor::Rendered rendered = service.render(image.request);
    volume::Image shown = copy_of(rendered.image);
    volume::FrameCounts counts;
    complete_image(march, image, service, shown, counts);
    const Unlikeness unlikeness(march, difference_between(draw.run.pipeline(), *looked_at, shown.view()));
    if (best != nullptr && !(unlikeness < least)) continue;
    best = &march;
    least = unlikeness;
  }
  if (best == nullptr) throw Refusal{"the driver offers no float framebuffer to compare images in"};
  return *best;
}

bool is_finished_here(const ImageRequest& image, const std::optional<March>& march) {
  return image.ray_caster && (needs_finish(*march) || image.parts.size() > 1);
}

}  // namespace understudy::spu
