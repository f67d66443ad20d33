// The volume unit's way for ray casters: from the draw of a box to a request.
#include <algorithm>
#include <cmath>

#include "compositor/blend.h"
#include "compositor/service/limits.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/ray_ends.h"
#include "spu/volume/substitution.h"
#include "spu/volume/verification/tile_comparison.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

/// A box whose texture coordinates are known by name: measured again when the program or the texture changes.
ProxyBox box_in(const MarchContext& measured, const CoordinateSpace& space) {
  const auto box = proxy_box(measured, space);
  if (!box) throw Refusal{"the near plane cuts the ray caster's box, or the eye is inside"};
  return *box;
}

/// Of the image's nine parts the one that shows something in most pixels: enough to tell marches by.
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

/// Planes where rays begin and end.
std::vector<volume::HalfSpace> ends_of(const ProxyBox& box, const Cuts& cuts) {
  std::vector<volume::HalfSpace> planes = box.cuts;
  planes.insert(planes.end(), cuts.clipping.begin(), cuts.clipping.end());
  return planes;
}

/// The request for a march through a volume that is cut.
void ask(volume::RenderRequest& request, const March& march, const ProxyBox& box, const Cuts& cuts) {
  ask_nodes(march, request);
  request.clip_planes = cuts.parts.front();
  const std::vector<volume::HalfSpace> planes = ends_of(box, cuts);
  if (!planes.empty() && march.steps.divided)
    throw Refusal{"planes cut a ray caster's box whose rays are divided evenly"};
  // One number a pixel travels to the nodes.
  if (!planes.empty() &&
      volume::footprint(request, request.region).pixels() > std::size_t(compositor::limits::max_ray_offsets))
    throw Refusal{"planes cut a ray caster's box in more pixels than the nodes take beginnings of rays for"};
  end_rays_at(planes, march.past_planes, request);
}

/// Vectors and matrices move with the camera where it has `turned`; one that changes alone may cut the volume.
void append_inputs(VerificationSchedule::Inputs& to, const MarchInputs& inputs, bool turned) {
  using Effect = VerificationSchedule::Effect;
  for (const float value : inputs.fixed) to.push_back({value});
  for (const float value : inputs.varying) {
    // Not a number: the depth of opaque geometry, which is drawn in every frame.
    to.push_back({std::isnan(value) ? 0.0F : value, turned ? Effect::followed : Effect::unknown});
  }
}

}  // namespace

void VolumeUnit::compose_proxy_request(Substitution& s, compositor::RenderService& service) {
  KnownVolume& known = s.volume;
  const auto record = chain_.group().programs().program(s.pipeline.program);
  const ProgramStages& parts = stages(s.pipeline.program, *record);
  const auto use = [&](const ProxyBox& box) {
    s.fit = box.camera;
    s.slices.region = box.region;
  };
  describe_volume(s);
  const auto context_of = [&] {
    return MarchContext{context(),  s.run, parts, known.texture, known.range, !s.cuts.clipping.empty(),
                        &*s.capture};
  };
  std::vector<CoordinateSpace> spaces;
  if (known.march) {
    spaces = {known.march->space};
  } else {
    spaces = coordinate_spaces(context_of());
    if (spaces.empty())
      throw Refusal{"no output of the vertex shader is a texture coordinate over the whole box"};
  }
  ProxyBox box = box_in(context_of(), spaces.front());
  use(box);
  s.eye_inside = !box.cuts.empty();
  if (s.eye_inside && !known.left_inside.empty()) throw Refusal{known.left_inside};
  s.cuts = read_cuts(context(), s.pipeline.program, box.camera.texture_to_clip);
  if (known.march && known.march->clipped == s.cuts.clipping.empty()) known.march.reset();
  upload(s, service);  // says what values there are

  const MarchContext measured = context_of();
  MarchInputs inputs = march_inputs(measured, chain_.group());
  const auto values = fragment_uniform_values(context(), s.pipeline.program, parts);
  if (std::string reason = refusal_of_ray_caster(findings(s, values)); !reason.empty())
    throw Refusal{std::move(reason)};
  append_inputs(s.inputs, inputs, known.camera != box.camera.texture_to_clip);
  known.camera = box.camera.texture_to_clip;
  if (known.march && !known.march->from_inside && !box.cuts.empty() &&
      inputs.fixed == known.march_inputs.fixed) {
    // Rays of all directions, which may show that the step was not known in every one.
    auto again = with_new_steps(measured, *known.march, box);
    if (const auto* reason = std::get_if<std::string>(&again)) throw Refusal{*reason};
    known.march = std::get<March>(std::move(again));
  }
  const bool same = known.march && inputs == known.march_inputs;
  const bool holds = same || (known.march && inputs.fixed == known.march_inputs.fixed &&
                              still_marches(measured, *known.march, box));
  const char* const why = !known.march ? "the first of the volume"
                          : !holds     ? "tables, uniforms or state that colours depend on changed"
                          : session_->disabled_optimizations(Optimization::known_colours) ? "asked to"
                                                                                          : "";
  count_probe(why);
  if (*why != '\0') {
    // Another table is usual while somebody edits one; where samples lie is not tried again for that.
    std::optional<March> again;
    if (known.march) again = with_new_table(measured, *known.march, box);
    known.march = again;
    if (!again) {
      if (known.refusals >= patient_refusals && session_->ledger().frames() % refused_retry_frames != 0)
        throw Refusal{known.last_reason};
      spaces = coordinate_spaces(measured);
      if (spaces.empty())
        throw Refusal{"no output of the vertex shader is a texture coordinate over the whole box"};
      box = box_in(measured, spaces.front());
      use(box);
      MarchFinding finding = measure_march(measured, spaces, box);
      if (const auto* reason = std::get_if<std::string>(&finding)) throw Refusal{*reason};
      known.march = choose_march(s, service, std::get<std::vector<March>>(finding));
      known.frames = 0;  // looked at again, as a new volume is
    }
    box = box_in(measured, known.march->space);
    use(box);
  }
  known.march_inputs = std::move(inputs);
  compose_request(s);
  hide_behind_geometry(s);
  s.opaque = s.request.depth;
  s.ray_ends = ends_of(box, s.cuts);
  ask(s.request, *known.march, box, s.cuts);
}

void VolumeUnit::complete_image(Substitution& s, compositor::RenderService& service, const March& march,
                                volume::Image& image, volume::FrameCounts& counts) {
  // The nodes leave out the rim that shows nothing.
  volume::Image whole(volume::footprint(s.request, s.request.region));
  std::fill(whole.rgba.begin(), whole.rgba.end(), volume::neutral_value(s.request.op));
  compositor::blend(s.request.op, whole, image.view());
  image = std::move(whole);
  for (std::size_t part = 1; part < s.cuts.parts.size(); ++part) {
    s.request.clip_planes = s.cuts.parts[part];
    const TimedShare timed(clock_, &FrameShares::render);
    const compositor::Rendered rendered = service.render(s.request);
    compositor::blend(s.request.op, image, rendered.image);
    counts += rendered.counts;
  }
  s.request.depth = s.opaque;
  if (needs_finish(march)) finish_image(march, image);
  if (march.sum && march.sum->everywhere) cover_entered(s.ray_ends, s.request, march.sum->alpha, image);
}

March VolumeUnit::choose_march(Substitution& s, compositor::RenderService& service,
                               const std::vector<March>& marches) {
  const auto record = chain_.group().programs().program(s.pipeline.program);
  const MarchContext measured{context(),        s.run,          stages(s.pipeline.program, *record),
                              s.volume.texture, s.volume.range, !s.cuts.clipping.empty(),
                              &*s.capture};
  std::optional<NativeImage> looked_at;
  const March* best = nullptr;
  double least = 0;
  for (const March& march : marches) {
    const auto box = proxy_box(measured, march.space);
    if (!box) continue;
    s.fit = box->camera;
    s.slices.region = box->region;
    compose_request(s);
    hide_behind_geometry(s);
    if (!looked_at) {
      s.drawn = native_image(context(), s.run, s.request, volume::footprint(s.request, s.request.region));
      if (!s.drawn) break;
      looked_at = fullest_part(*s.drawn);
    }
    s.request.window = intersection(s.request.window, looked_at->rect);
    s.opaque = s.request.depth;
    s.ray_ends = ends_of(*box, s.cuts);
    ask(s.request, march, *box, s.cuts);
    const compositor::Rendered rendered = service.render(s.request);
    volume::Image image = copy_of(rendered.image);
    volume::FrameCounts counts;
    complete_image(s, service, march, image, counts);
    const double difference = difference_between(s.pipeline, *looked_at, image.view()).mean_square;
    if (best != nullptr && difference >= least) continue;
    best = &march;
    least = difference;
  }
  if (best == nullptr) throw Refusal{"the driver offers no float framebuffer to compare images in"};
  return *best;
}

}  // namespace understudy::spu
