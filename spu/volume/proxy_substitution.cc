// The volume unit's way for ray casters: from the draw of a box to a request.
#include <algorithm>

#include "spu/volume/proxy/march.h"
#include "spu/volume/substitution.h"
#include "spu/volume/verify.h"
#include "volume/footprint.h"

namespace understudy::spu {
namespace {

/// A box whose texture coordinates are known by name: measured again when the program or the texture changes.
ProxyBox box_in(const MarchContext& measured, const CoordinateSpace& space) {
  const auto box = proxy_box(measured, space);
  if (!box) throw Doubt{"the near plane cuts the ray caster's box, or the eye is inside"};
  return *box;
}

/// Of the picture's nine parts the one that shows something in most pixels: enough to tell marches by.
ApplicationPicture fullest_part(const ApplicationPicture& whole) {
  const volume::Rect& all = whole.rect;
  const int columns = std::max(1, all.width / 3);
  const int rows = std::max(1, all.height / 3);
  ApplicationPicture fullest;
  std::size_t most = 0;
  for (int y = 0; y + rows <= all.height; y += rows) {
    for (int x = 0; x + columns <= all.width; x += columns) {
      ApplicationPicture part{{all.x + x, all.y + y, columns, rows}, {}};
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

void ask_for(volume::RenderRequest& request, const March& march) {
  request.steps = march.steps;
  request.op = march.extreme.value_or(volume::Operator::over);
  request.classification = asked_of_nodes(march);
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
  const auto context_of = [&] { return MarchContext{context(), s.run, parts, known.texture, known.range}; };
  std::vector<CoordinateSpace> spaces;
  if (known.march) {
    spaces = {known.march->space};
  } else {
    spaces = coordinate_spaces(context_of());
    if (spaces.empty())
      throw Doubt{"no output of the vertex shader is a texture coordinate over the whole box"};
  }
  use(box_in(context_of(), spaces.front()));
  upload(s, service);  // says what values there are

  const MarchContext measured = context_of();
  MarchInputs inputs = march_inputs(measured, chain_.group());
  ProxyBox box{s.slices.region, *s.fit};
  const bool same = known.march && inputs == known.march_inputs;
  const bool holds = same || (known.march && inputs.fixed == known.march_inputs.fixed &&
                              still_marches(measured, *known.march, box));
  if (!holds) {
    // Another table is usual while somebody edits one; where samples lie is not tried again for that.
    std::optional<March> again;
    if (known.march) again = with_new_table(measured, *known.march, box);
    known.march = again;
    if (!again) {
      if (known.refusals >= patient_refusals && session_->ledger().frames() % refused_retry_frames != 0)
        throw Doubt{known.last_reason};
      spaces = coordinate_spaces(measured);
      if (spaces.empty())
        throw Doubt{"no output of the vertex shader is a texture coordinate over the whole box"};
      box = box_in(measured, spaces.front());
      use(box);
      MarchFinding finding = measure_march(measured, spaces, box);
      if (const auto* reason = std::get_if<std::string>(&finding)) throw Doubt{*reason};
      known.march = choose_march(s, service, std::get<std::vector<March>>(finding));
      known.frames = 0;  // looked at again, as a new volume is
    }
  }
  known.march_inputs = std::move(inputs);
  use(box_in(measured, known.march->space));
  compose_request(s);
  ask_for(s.request, *known.march);
}

March VolumeUnit::choose_march(Substitution& s, compositor::RenderService& service,
                               const std::vector<March>& marches) {
  const auto record = chain_.group().programs().program(s.pipeline.program);
  const MarchContext measured{context(), s.run, stages(s.pipeline.program, *record), s.volume.texture,
                              s.volume.range};
  std::optional<ApplicationPicture> looked_at;
  const March* best = nullptr;
  double least = 0;
  for (const March& march : marches) {
    const auto box = proxy_box(measured, march.space);
    if (!box) continue;
    s.fit = box->camera;
    s.slices.region = box->region;
    compose_request(s);
    ask_for(s.request, march);
    if (!looked_at) {
      s.drawn =
          application_picture(context(), s.run, s.request, volume::footprint(s.request, s.request.region));
      if (!s.drawn) break;
      looked_at = fullest_part(*s.drawn);
    }
    s.request.window = intersection(s.request.window, looked_at->rect);
    const compositor::Rendered rendered = service.render(s.request);
    volume::Image picture;
    picture.rect = rendered.image.rect;
    picture.rgba.assign(rendered.image.rgba.begin(), rendered.image.rgba.end());
    if (march.extreme) classify_extremes(march, picture);
    const double difference = difference_between(s.pipeline, *looked_at, picture.view()).mean_square;
    if (best != nullptr && difference >= least) continue;
    best = &march;
    least = difference;
  }
  if (best == nullptr) throw Doubt{"the driver offers no float framebuffer to compare pictures in"};
  return *best;
}

}  // namespace understudy::spu
