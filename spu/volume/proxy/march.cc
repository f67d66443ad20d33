#include "spu/volume/proxy/march.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spu/volume/proxy/cut_box.h"
#include "spu/volume/proxy/cuts.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/step_fit.h"
#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

using volume::Rgba;
using volume::Vec3;

/// Multiples of 1/255 fall on entries.
constexpr int table_entries = 4 * 255 + 1;
constexpr float never_equal = std::numeric_limits<float>::quiet_NaN();
constexpr int bands = 24;  ///< of two rows each, on which samples are counted

float value_at(const std::array<float, 2>& range, double place) {
  return float(range[0] + place * (double(range[1]) - range[0]));
}

bool reached(const Rgba& fragment) {
  return fragment[3] != no_fragment;
}

bool finite(const std::vector<Rgba>& fragments) {
  return std::all_of(fragments.begin(), fragments.end(), [](const Rgba& f) {
    return std::all_of(f.begin(), f.end(), [](float x) { return std::isfinite(x); });
  });
}

/// The fragment as it would be blended: premultiplied.
Rgba premultiplied(Rgba fragment, bool already) {
  if (!reached(fragment)) return {};
  for (std::size_t c = 0; c < 3 && !already; ++c) fragment[c] *= fragment[3];
  return fragment;
}

float brightest_channel(const Rgba& colour) {
  return std::max({colour[0], colour[1], colour[2]});
}

/// One of `n` equal samples that make up `ray`, both premultiplied.
Rgba sample_of(const March& march, const Rgba& ray, double n) {
  if (march.sum) return {float(ray[0] / n), float(ray[1] / n), float(ray[2] / n), 1};
  if (n == 1) return ray;
  Rgba sample{};
  sample[3] = float(-std::expm1(std::log1p(-std::min(double(ray[3]), 1.0)) / n));
  const float part = ray[3] > 0 ? sample[3] / ray[3] : float(1 / n);
  for (std::size_t c = 0; c < 3; ++c) sample[c] = ray[c] * part;
  return sample;
}

Rgba ray_of(const March& march, const Rgba& sample, double n) {
  if (march.sum) {
    Rgba ray{0, 0, 0, march.sum->alpha};
    for (std::size_t c = 0; c < 3; ++c) ray[c] = std::min(float(sample[c] * n), march.sum->ceiling);
    return ray;
  }
  Rgba ray{};
  ray[3] = float(-std::expm1(n * std::log1p(-std::min(double(sample[3]), 1.0))));
  const float times = sample[3] > 0 ? ray[3] / sample[3] : float(n);
  for (std::size_t c = 0; c < 3; ++c) ray[c] = sample[c] * times;
  return ray;
}

Rgba table_at(const volume::TransferFunction& table, float value) {
  const auto last = float(table.entries.size() - 1);
  const float place = std::clamp((value - table.low) / (table.high - table.low), 0.0F, 1.0F) * last;
  const auto below = std::size_t(place);
  const std::size_t above = std::min(below + 1, table.entries.size() - 1);
  const float s = place - float(below);
  Rgba colour;
  for (std::size_t c = 0; c < 4; ++c)
    colour[c] = table.entries[below][c] + s * (table.entries[above][c] - table.entries[below][c]);
  return colour;
}

float largest_difference(const Rgba& a, const Rgba& b) {
  float largest = 0;
  for (std::size_t c = 0; c < 4; ++c) largest = std::max(largest, std::abs(a[c] - b[c]));
  return largest;
}

/// How much of a ray's samples is seen: between nothing and 1, but for sums that shine brighter.
float amount(const March& march, const Rgba& ray) {
  return march.sum ? brightest_channel(ray) / std::min(1.0F, march.sum->ceiling) : ray[3];
}

/// Samples that are added up under one opacity, as `through` and `briefly`, a long ray and a short one over the
/// same fields, show them.
std::optional<PlainSum> plain_sum(const std::vector<Rgba>& through, const std::vector<Rgba>& briefly) {
  constexpr float same = 1e-3F;
  const float alpha = through.front()[3];
  if (!(alpha > 0)) return std::nullopt;
  for (const auto* rays : {&through, &briefly}) {
    for (const Rgba& ray : *rays) {
      if (!(std::abs(ray[3] - alpha) <= same)) return std::nullopt;
    }
  }
  PlainSum sum{alpha, false};
  float largest = 0;
  for (const Rgba& ray : through) largest = std::max(largest, brightest_channel(ray));
  // A sum that several values reach is where the program stops counting.
  const auto reached_by = std::count_if(through.begin(), through.end(), [&](const Rgba& ray) {
    return largest - brightest_channel(ray) <= 1e-6F * largest;
  });
  if (reached_by > 1) sum.ceiling = largest;
  return sum;
}

struct Ray {
  double x = 0;
  double y = 0;
  double length = 0;  ///< in steps
};

/// The ray in view whose length comes closest to `wanted` steps, looked for from the middle of the box
/// outwards.
Ray ray_of_length(const RaysThroughBox& rays, const volume::RaySteps& steps, double wanted) {
  const auto length_at = [&](double x, double y) {
    const auto way = rays.way(x, y);
    return way ? steps_of_way(steps, *way) : 0.0;
  };
  const auto middle = rays.middle();
  const double mx = std::clamp(middle[0], -0.9, 0.9);
  const double my = std::clamp(middle[1], -0.9, 0.9);
  Ray best{mx, my, length_at(mx, my)};
  for (int direction = 0; direction < 16; ++direction) {
    const double angle = M_PI / 8 * direction + 0.1;
    double inside = 0;
    double outside = 3;
    for (int halving = 0; halving < 24; ++halving) {
      const double reach = (inside + outside) / 2;
      const double x = mx + reach * std::cos(angle);
      const double y = my + reach * std::sin(angle);
      const bool in_view = std::abs(x) < 0.99 && std::abs(y) < 0.99;
      const double length = in_view ? length_at(x, y) : 0;
      if (length > 0 && std::abs(length - wanted) < std::abs(best.length - wanted)) best = {x, y, length};
      (length > wanted ? inside : outside) = reach;
    }
  }
  return best;
}

constexpr float same_but_for_rounding = 0.02F;
/// Lighting needs a gradient, however small: by so much of the range of values the fields rise that show it.
constexpr float slight_rise = 1e-5F;

bool depends_on_gradient(const MarchContext& measured, FieldProbe& probe, const Ray& ray, float value) {
  const float rise = slight_rise * (measured.range[1] - measured.range[0]);
  const std::array one{value};
  const Rgba flat = probe.at(ray.x, ray.y, one).front();
  const Rgba sloping = probe.at_slope(ray.x, ray.y, one, rise).front();
  return !(largest_difference(flat, sloping) <= same_but_for_rounding);
}

/// Whether the colour jumps at `value`: a slope there says nothing about lighting.
bool is_at_step(const MarchContext& measured, FieldProbe& probe, const Ray& ray, float value) {
  const float rise = slight_rise * (measured.range[1] - measured.range[0]);
  const std::array around{std::max(value - rise, measured.range[0]), value,
                          std::min(value + rise, measured.range[1])};
  const auto colours = probe.at(ray.x, ray.y, around);
  return !(largest_difference(colours[0], colours[1]) <= same_but_for_rounding &&
           largest_difference(colours[1], colours[2]) <= same_but_for_rounding);
}

/// A value whose field lets about half of the light through a ray.
struct TranslucentRay {
  Ray ray;
  float value = 0;
};

/// On the longest ray on which there is one: where samples are nearly opaque, only short rays let light
/// through.
std::optional<TranslucentRay> translucent_ray(const MarchContext& measured, FieldProbe& probe,
                                              const RaysThroughBox& rays, const volume::RaySteps& texels,
                                              const March& march, const std::vector<float>& values) {
  constexpr float too_far_from_half = 0.48F;
  constexpr std::size_t looked_at = 4;
  const auto middle = rays.middle();
  const auto way = rays.way(middle[0], middle[1]);
  const Ray longest{middle[0], middle[1], way ? steps_of_way(texels, *way) : 0};
  for (const double part : {1.0, 0.25, 0.0625}) {
    const Ray ray = part == 1 ? longest : ray_of_length(rays, texels, part * longest.length);
    const auto fragments = probe.at(ray.x, ray.y, values);
    std::vector<std::pair<float, float>> by_distance;  // from half, and the value
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      const float distance = std::abs(amount(march, fragments[i]) - 0.5F);
      if (reached(fragments[i]) && distance < too_far_from_half) by_distance.emplace_back(distance, values[i]);
    }
    std::ranges::sort(by_distance);
    by_distance.resize(std::min(by_distance.size(), looked_at));
    for (const auto& [distance, value] : by_distance) {
      if (!is_at_step(measured, probe, ray, value)) return TranslucentRay{ray, value};
    }
  }
  return std::nullopt;
}

/// Counts of samples on rays all over the box.
std::variant<std::vector<CountedRay>, std::string> counted_rays(const MarchContext& measured, FieldProbe& probe,
                                                                const RaysThroughBox& rays,
                                                                const March& march) {
  // Where nearly nothing is let through any more, programs stop, or one sample makes no difference.
  constexpr float most_counted = 0.99F;
  const bool already = measured.run.pipeline().blending.premultiplied;
  std::vector<CountedRay> counted;
  std::vector<double> amounts;
  std::vector<Rgba> colours;
  for (int band = 0; band < bands; ++band) {
    const int y = std::clamp((2 * band + 1) * probe.height() / (2 * bands), 0, std::max(0, probe.height() - 2));
    const auto fragments = probe.rows(y, 2, march.translucent);
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      if (!reached(fragments[i])) continue;
      const int column = int(i) % probe.width();
      const int row = y + int(i) / probe.width();
      const auto way = rays.way(2 * (column + 0.5) / probe.width() - 1, 2 * (row + 0.5) / probe.height() - 1);
      const float seen = amount(march, premultiplied(fragments[i], already));
      if (!way || (!march.sum && seen > most_counted)) continue;
      counted.push_back({*way, 0, probe.left() + column, probe.bottom() + row});
      colours.push_back(premultiplied(fragments[i], already));
      amounts.push_back(double(amount(march, colours.back())));
    }
  }
  if (counted.size() < 64) return "too little of the box is in view to measure its rays";
  const auto most = std::max_element(amounts.begin(), amounts.end());
  const std::vector<double> counts = march.sum ? counts_from_amounts(amounts) : counts_from_opacities(amounts);
  if (counts.empty() && march.sum) return "the colours of a ray's samples do not add up";
  if (counts.empty()) return "the samples of a ray are not composed by over (a plain sum, or lighting)";
  // Colour over opacity stays what it is for one sample.
  const std::size_t longest = std::size_t(most - amounts.begin());
  for (std::size_t i = 0; i < counted.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = double(colours[longest][c]) / *most * amounts[i];
      if (std::abs(colours[i][c] - expected) > 0.01)
        return "the colours of a ray's samples are not composed by over";
    }
    counted[i].samples = counts[i];
  }
  return counted;
}

/// The length from which on a ray has a sample, in steps of `texels`: at the box's silhouette rays are as short
/// as can be, and those that are too short show nothing. `shown` is what the field of `value` looks like.
double shortest_seen(FieldProbe& probe, const RaysThroughBox& rays, const volume::RaySteps& texels, float value,
                     const Rgba& shown) {
  const std::array one{value};
  const auto middle = rays.middle();
  const double mx = std::clamp(middle[0], -0.9, 0.9);
  const double my = std::clamp(middle[1], -0.9, 0.9);
  std::vector<double> lengths;
  for (int direction = 0; direction < 5; ++direction) {
    const double angle = 2 * M_PI / 5 * direction + 0.1;
    double inside = 0;
    double outside = 3;
    double length = 0;
    for (int halving = 0; halving < 16; ++halving) {
      const double reach = (inside + outside) / 2;
      const double x = mx + reach * std::cos(angle);
      const double y = my + reach * std::sin(angle);
      const bool in_view = std::abs(x) < 0.99 && std::abs(y) < 0.99;
      const auto way = rays.way(x, y);
      const bool seen =
          in_view && way && largest_difference(probe.at(x, y, one).front(), shown) < 0.01F * shown[3];
      (seen ? inside : outside) = reach;
      if (seen) length = steps_of_way(texels, *way);
    }
    lengths.push_back(length);
  }
  // Where the window ends before the box does, rays stay long: the shortest of all is the silhouette's.
  return *std::min_element(lengths.begin(), lengths.end());
}

/// For an extreme value, which does not tell how many samples it was taken of: one or two a texel, or one for
/// each length of the shortest ray that has any.
std::vector<volume::RaySteps> rules_for_extremes(const std::array<int, 3>& size, double shortest) {
  constexpr double none = 0.02;  // of a texel
  std::vector<volume::RaySteps> rules;
  const auto add = [&](double density) {
    volume::RaySteps steps;
    for (std::size_t k = 0; k < 3; ++k) steps.metric[4 * k] = density * size[k];
    steps.first = shortest < none ? 0 : shortest * density;
    rules.push_back(steps);
  };
  add(1);
  add(2);
  if (shortest > 0.25 && shortest < 2) add(1 / shortest);
  return rules;
}

/// The colour of one sample of every value, into the march's table. Several rays are asked, from one sample on:
/// the longest that is not opaque tells best, because some programs keep a ray's opacity above a floor.
std::optional<std::string> measure_table(const MarchContext& measured, FieldProbe& probe,
                                         const RaysThroughBox& rays, const volume::RaySteps& rule,
                                         March& march) {
  constexpr float opaque = 0.6F;
  constexpr float saturated = 0.97F;
  constexpr double most_samples_of_shortest = 8;
  const bool already = measured.run.pipeline().blending.premultiplied;
  std::vector<float> values;
  values.reserve(table_entries);
  for (int i = 0; i < table_entries; ++i)
    values.push_back(value_at(measured.range, double(i) / (table_entries - 1)));
  auto& entries = march.table.entries;
  entries.clear();
  std::vector<float> shortest;  // opacity of the shortest ray
  for (const double samples : {1.0, 6.0, 40.0}) {
    const double wanted = march.extreme ? 3.0 : samples - 0.5 + (rule.divided ? 0.5 : rule.first);
    const Ray ray = ray_of_length(rays, rule, wanted);
    const double n = march.extreme ? 1 : samples_of_length(rule, ray.length);
    if (entries.empty() && n < 1) return "no short ray is in view: the opacity of one sample cannot be told";
    const bool long_at_best = entries.empty() && n > most_samples_of_shortest;
    if (!entries.empty() && std::abs(n - samples) > samples / 2) continue;
    const auto fragments = probe.at(ray.x, ray.y, values);
    if (!finite(fragments)) return "the fragment stage gives colours that are not finite";
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      const Rgba colour = premultiplied(fragments[i], already);
      const float seen = amount(march, colour);
      // Whatever more a sample had, a ray of many would look alike.
      if (long_at_best && seen > saturated)
        return "no short ray is in view: the opacity of one sample cannot be told";
      if (entries.size() <= i) {
        entries.push_back(march.extreme ? colour : sample_of(march, colour, n));
        shortest.push_back(seen);
      } else if (seen < opaque) {
        // An opacity that does not grow with the way is that floor.
        const bool grows = seen > shortest[i] + 1e-5F;
        entries[i] = grows ? sample_of(march, colour, n) : Rgba{0, 0, 0, march.sum ? 1.0F : 0.0F};
      }
    }
    if (march.extreme) break;
  }
  return std::nullopt;
}

/// Noise at the rays' beginnings, where there is any, is taken away.
bool held_still(const MarchContext& measured, FieldProbe& probe, const March& march) {
  return !march.jitter || hold_still(measured.run, probe, *march.jitter);
}

bool is_scalar(GLenum type) {
  switch (type) {
    case GL_FLOAT_VEC2:
    case GL_FLOAT_VEC3:
    case GL_FLOAT_VEC4:
    case GL_FLOAT_MAT2:
    case GL_FLOAT_MAT3:
    case GL_FLOAT_MAT4:
      return false;
    default:
      return true;
  }
}

std::size_t components(GLenum type) {
  switch (type) {
    case GL_FLOAT_VEC2:
      return 2;
    case GL_FLOAT_VEC3:
      return 3;
    case GL_FLOAT_VEC4:
    case GL_FLOAT_MAT2:
      return 4;
    case GL_FLOAT_MAT3:
      return 9;
    case GL_FLOAT_MAT4:
      return 16;
    default:
      return 1;
  }
}

/// What the polygons of a draw enclose.
std::optional<CutBox> body_of(const Capture& capture) {
  if (const auto box = box_of(capture.polygons, capture.fit->texture_to_clip)) return CutBox{*box, {}};
  return cut_box_of(capture.polygons);
}

/// With `input` for the coordinate; in `captured`, unless the run was captured so before.
const Capture& capture_by(const MarchContext& measured, const std::string& input, Capture& captured) {
  if (measured.seen != nullptr && measured.seen->coordinate == input) return *measured.seen;
  captured = capture_vertices(measured.context, measured.run, measured.stages, input);
  return captured;
}

bool is_cut(const CutBox& body) {
  return volume::length(body.cut.normal) > 0;
}

}  // namespace

MarchInputs march_inputs(const MarchContext& measured, const ShareGroup& group) {
  const DispatchTable& gl = *measured.context.gl;
  const Pipeline& pipeline = measured.run.pipeline();
  MarchInputs inputs;
  inputs.fixed = {measured.range[0], measured.range[1], pipeline.blending.premultiplied ? 1.0F : 0.0F,
                  float(measured.texture.base)};
  for (const int extent : measured.texture.size) inputs.fixed.push_back(float(extent));
  for (const GLint swizzle : measured.texture.swizzle) inputs.fixed.push_back(float(swizzle));
  if (measured.stages.uniform_blocks) inputs.varying.push_back(never_equal);
  const auto record = group.programs().program(pipeline.program);
  inputs.fixed.push_back(record ? float(record->link) : 0.0F);
  for (const StageUniform& uniform : measured.stages.uniforms) {
    if (tells_cuts(uniform.name)) continue;  // measured without
    const GLint location = gl.GetUniformLocation(pipeline.program, uniform.name.c_str());
    if (location < 0) continue;
    std::array<GLfloat, 16> value{};
    gl.GetUniformfv(pipeline.program, location, value.data());
    auto& to = is_scalar(uniform.type) ? inputs.fixed : inputs.varying;
    to.insert(to.end(), value.begin(), value.begin() + std::ptrdiff_t(components(uniform.type)));
  }
  for (const SampledTexture& other : pipeline.others) {
    if (group.is_rendered_to(other.texture)) {  // the opaque geometry's depth, or a table that is drawn
      inputs.varying.push_back(never_equal);
      continue;
    }
    inputs.fixed.push_back(float(other.texture));
    inputs.fixed.push_back(float(group.texture_version(other.texture)));
  }
  return inputs;
}

bool draws_box(const GlContext& context, const Run& run, const ProgramStages& stages, const Capture& seen) {
  constexpr std::size_t most_triangles = 4096;  // of a box
  if (seen.polygons.count() > most_triangles) return false;
  if (seen.fit && body_of(seen)) return true;
  return std::any_of(stages.inputs.begin(), stages.inputs.end(), [&](const StageInput& input) {
    if (input.integer || input.components < 3 || input.name == seen.coordinate) return false;
    const Capture capture = capture_vertices(context, run, stages, input.name);
    return capture.fit && body_of(capture);
  });
}

std::vector<CoordinateSpace> coordinate_spaces(const MarchContext& measured) {
  std::vector<CoordinateSpace> of_texels;
  Capture captured;
  const auto& size = measured.texture.size;
  for (const StageInput& input : measured.stages.inputs) {
    if (input.integer || input.components < 3) continue;
    const Capture& capture = capture_by(measured, input.name, captured);
    if (!capture.fit) continue;
    const auto body = body_of(capture);
    if (!body) continue;
    const volume::Box& box = body->box;
    bool unit = true;
    bool texels = true;
    CoordinateSpace in_texels{input.name};
    for (std::size_t k = 0; k < 3; ++k) {
      const double n = size[k];
      const double slack = 1.01 / n;
      unit = unit && box.low[k] >= -slack && box.high[k] <= 1 + slack;
      texels = texels && box.low[k] >= -1.01 && box.high[k] <= n + 1.01;
      in_texels.scale[k] = 1 / n;
    }
    if (unit) return {{input.name}};
    if (!texels || !of_texels.empty()) continue;
    of_texels.push_back(in_texels);
    for (std::size_t k = 0; k < 3; ++k) in_texels.offset[k] = 0.5 / size[k];
    of_texels.push_back(in_texels);
  }
  return of_texels;
}

std::optional<ProxyBox> proxy_box(const MarchContext& measured, const CoordinateSpace& space) {
  Capture captured;
  const Capture& capture = capture_by(measured, space.input, captured);
  if (!capture.fit || capture.fit->residual > max_fit_residual) return std::nullopt;
  const auto body = body_of(capture);
  if (!body || !wholly_in_view(capture.polygons)) return std::nullopt;
  if (!is_cut(*body) && !wholly_in_view(capture.fit->texture_to_clip, body->box)) return std::nullopt;
  ProxyBox proxy{body->box, *capture.fit, {}};
  volume::HalfSpace cut{{}, body->cut.offset};
  volume::Matrix4 to_input = volume::identity();
  for (std::size_t k = 0; k < 3; ++k) {
    proxy.region.low[k] = space.scale[k] * body->box.low[k] + space.offset[k];
    proxy.region.high[k] = space.scale[k] * body->box.high[k] + space.offset[k];
    cut.normal[k] = body->cut.normal[k] / space.scale[k];
    cut.offset -= cut.normal[k] * space.offset[k];
    to_input[5 * k] = 1 / space.scale[k];
    to_input[4 * k + 3] = -space.offset[k] / space.scale[k];
  }
  if (is_cut(*body)) proxy.cuts.push_back(cut);
  proxy.camera.texture_to_clip = volume::multiply(capture.fit->texture_to_clip, to_input);
  return proxy;
}

MarchFinding measure_march(const MarchContext& measured, const std::vector<CoordinateSpace>& spaces,
                           const ProxyBox& box) {
  if (measured.texture.base == BaseFormat::rgba) return "a ray caster over a texture of colours";
  FieldProbe probe(measured.context, measured.run, measured.texture);
  if (!probe.complete()) return "the driver offers no float framebuffer to probe with";
  const auto& size = measured.texture.size;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  volume::RaySteps texels;
  for (std::size_t k = 0; k < 3; ++k) texels.metric[4 * k] = size[k];

  constexpr int tried = 128;
  std::vector<float> values;
  values.reserve(tried);
  for (int i = 0; i < tried; ++i) values.push_back(value_at(measured.range, double(i) / (tried - 1)));
  const auto middle = rays.middle();
  const auto through = probe.at(middle[0], middle[1], values);
  const Ray brief = ray_of_length(rays, texels, 3);
  const auto briefly = probe.at(brief.x, brief.y, values);
  if (!finite(through) || !finite(briefly)) return "the fragment stage gives colours that are not finite";
  March march;
  march.clipped = measured.clipped;
  march.from_inside = !box.cuts.empty();
  // Whatever the way through it, one value has one colour: samples are not composed.
  march.extreme = volume::Operator::max;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(largest_difference(through[i], briefly[i]) <= 2e-3F)) march.extreme.reset();
  }
  if (!march.extreme) march.sum = plain_sum(through, briefly);
  const auto reference_way = rays.way(middle[0], middle[1]);
  if (march.extreme && (!reference_way || steps_of_way(texels, *reference_way) < 2 * brief.length))
    return "rays of one length alone do not tell the step";

  if (march.extreme) {
    march.translucent = values[tried / 2];
    if (depends_on_gradient(measured, probe, {middle[0], middle[1]}, march.translucent))
      return "the colour depends on the gradient (lighting)";
  } else {
    const auto found = translucent_ray(measured, probe, rays, texels, march, values);
    if (!found) return "no value is translucent on any ray: samples cannot be counted";
    if (depends_on_gradient(measured, probe, found->ray, found->value))
      return "the colour depends on the gradient (lighting)";
    march.translucent = found->value;
  }

  if (march.sum) {
    constexpr double none = 0.02;  // of a texel
    const auto dark = std::find_if(through.begin(), through.end(),
                                   [](const Rgba& ray) { return brightest_channel(ray) == 0; });
    if (dark != through.end())
      march.sum->everywhere =
          shortest_seen(probe, rays, texels, values[std::size_t(dark - through.begin())], *dark) < none;
  }
  std::vector<volume::RaySteps> rules;
  if (march.extreme) {
    const auto brightest = std::max_element(through.begin(), through.end(),
                                            [](const Rgba& a, const Rgba& b) { return a[3] < b[3]; });
    const double shortest =
        (*brightest)[3] > 0
            ? shortest_seen(probe, rays, texels, values[std::size_t(brightest - through.begin())], *brightest)
            : 0;
    rules = rules_for_extremes(size, shortest);
  } else {
    const auto count = [&] { return counted_rays(measured, probe, rays, march); };
    const auto counted = count();
    if (const auto* reason = std::get_if<std::string>(&counted)) return *reason;
    const auto& all = std::get<std::vector<CountedRay>>(counted);
    auto fits = fit_steps(all, size);
    if (fits.empty()) return "too few rays of several samples are in view to tell the step";
    if (fits.front().unexplained > most_unexplained) {
      auto finding = find_jitter(measured.context, measured.run, probe, count, all, size);
      if (!finding) return "samples do not lie on constant steps from the box's faces (jitter, cropping)";
      march.jitter = finding->jitter;
      fits = std::move(finding->fits);
    }
    for (const StepFit& fit : fits) {
      std::vector<volume::RaySteps> of_fit = rules_of(fit);
      // A way in equal parts has as many wherever the first one begins.
      if (march.jitter || measured.clipped || !box.cuts.empty()) of_fit.resize(1);
      rules.insert(rules.end(), of_fit.begin(), of_fit.end());
    }
  }

  march.table.low = measured.range[0];
  march.table.high = measured.range[1];
  if (auto reason = measure_table(measured, probe, rays, rules.front(), march)) return *reason;

  if (march.jitter) {
    const auto offsets = ray_offsets(measured.context, measured.run, *march.jitter);
    if (!offsets) return "the texture of noise at the rays' beginnings cannot be read back";
    for (volume::RaySteps& rule : rules) rule.offsets = offsets;
  }
  std::vector<March> marches;
  const bool ends_at_depth = samples_depth(measured.context, measured.run.pipeline());
  for (const CoordinateSpace& space : spaces) {
    for (const volume::RaySteps& rule : rules) {
      march.space = space;
      march.steps = rule;
      // The step that reaches the opaque geometry is usually taken before it is noticed.
      march.steps.past_depth = ends_at_depth ? 1 : 0;
      // Planes end rays as opaque geometry does; where no ray leaves by one, both images are alike.
      for (const double past_planes : {march.steps.past_depth, 1 - march.steps.past_depth}) {
        if (!measured.clipped && past_planes != march.steps.past_depth) continue;
        march.past_planes = past_planes;
        marches.push_back(march);
        // Fields of one value do not tell which extreme it is.
        if (!march.extreme) continue;
        marches.push_back(march);
        marches.back().extreme = volume::Operator::min;
      }
    }
  }
  return marches;
}

std::optional<March> with_new_table(const MarchContext& measured, const March& march, const ProxyBox& box) {
  March changed = march;
  changed.table.low = measured.range[0];
  changed.table.high = measured.range[1];
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  {
    FieldProbe probe(measured.context, measured.run, measured.texture);
    if (!probe.complete() || !held_still(measured, probe, march)) return std::nullopt;
    if (measure_table(measured, probe, rays, march.steps, changed)) return std::nullopt;
  }
  if (march.jitter) {
    changed.steps.offsets = ray_offsets(measured.context, measured.run, *march.jitter);
    if (!changed.steps.offsets) return std::nullopt;
  }
  const auto middle = rays.middle();
  const auto way = rays.way(middle[0], middle[1]);
  if (!way) return std::nullopt;
  float nearest = 0.48F;
  const auto& table = changed.table;
  for (std::size_t i = 0; i < table.entries.size() && !march.extreme; ++i) {
    const float through = amount(march, ray_of(march, table.entries[i], steps_of_way(march.steps, *way)));
    if (std::abs(through - 0.5F) >= nearest) continue;
    nearest = std::abs(through - 0.5F);
    changed.translucent = value_at(measured.range, double(i) / double(table.entries.size() - 1));
  }
  if ((nearest == 0.48F && !march.extreme) || !still_marches(measured, changed, box)) return std::nullopt;
  return changed;
}

std::variant<March, std::string> with_new_steps(const MarchContext& measured, const March& march,
                                                const ProxyBox& box) {
  March changed = march;
  changed.from_inside = true;
  if (march.extreme) return changed;  // taken at one step or another, it is the same
  FieldProbe probe(measured.context, measured.run, measured.texture);
  if (!probe.complete() || !held_still(measured, probe, march))
    return "the driver offers no float framebuffer to probe with";
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const auto counted = counted_rays(measured, probe, rays, march);
  if (const auto* reason = std::get_if<std::string>(&counted)) return *reason;
  for (const StepFit& fit : fit_steps(std::get<std::vector<CountedRay>>(counted), measured.texture.size)) {
    const volume::RaySteps rule = rules_of(fit).front();
    if (fit.unexplained > most_unexplained || rule.first != march.steps.first) continue;
    changed.steps.metric = rule.metric;
    return changed;
  }
  return "the steps of rays are others where the eye is inside";
}

bool still_marches(const MarchContext& measured, const March& march, const ProxyBox& box) {
  constexpr float same_colour = 5e-3F;
  FieldProbe probe(measured.context, measured.run, measured.texture);
  if (!probe.complete() || !held_still(measured, probe, march)) return false;
  const bool already = measured.run.pipeline().blending.premultiplied;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const double wanted = march.extreme ? 3 : 0.5 + (march.steps.divided ? 0.5 : march.steps.first);
  const Ray shortest = ray_of_length(rays, march.steps, wanted);
  constexpr int looked_at = 16;
  std::vector<float> values;
  values.reserve(looked_at);
  for (int i = 0; i < looked_at; ++i)
    values.push_back(value_at({march.table.low, march.table.high}, (i + 0.5) / looked_at));
  const auto expected = [&](const Rgba& fragment, float value, double n) {
    const Rgba sample = table_at(march.table, value);
    const Rgba got = premultiplied(fragment, already);
    if (march.extreme) return largest_difference(got, sample) <= same_colour;
    // A ray whose end falls on a sample may have one more or less.
    for (const double count : {n, n - 1, n + 1}) {
      if (count >= 1 && largest_difference(got, ray_of(march, sample, count)) <= same_colour) return true;
    }
    return false;
  };
  const double samples = march.extreme ? 1 : samples_of_length(march.steps, shortest.length);
  const auto fragments = probe.at(shortest.x, shortest.y, values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!expected(fragments[i], values[i], samples)) return false;
  }
  if (march.extreme) return true;
  // A long ray: its step may have another length in another direction.
  const auto middle = rays.middle();
  const int column = std::clamp(int((middle[0] + 1) / 2 * probe.width()), 0, probe.width() - 1);
  const int row = std::clamp(int((middle[1] + 1) / 2 * probe.height()), 0, probe.height() - 1);
  const auto way = rays.way(2 * (column + 0.5) / probe.width() - 1, 2 * (row + 0.5) / probe.height() - 1);
  if (!way) return true;
  return expected(probe.pixel(column, row, march.translucent), march.translucent,
                  samples_of_length(march.steps, steps_of_way(march.steps, *way)));
}

void ask_nodes(const March& march, volume::RenderRequest& request) {
  request.steps = march.steps;
  if (!march.extreme) {
    request.op = march.sum ? volume::Operator::add : volume::Operator::over;
    request.classification = march.table;
    return;
  }
  request.op = *march.extreme;
  // The value travels in the first channel. Where the lowest one is invisible, blocks of nothing else add
  // nothing to a maximum; to a minimum they do.
  const Rgba& lowest = march.table.entries.front();
  const bool all_visible = march.extreme == volume::Operator::min ||
                           std::any_of(lowest.begin(), lowest.end(), [](float x) { return x > 0; });
  volume::TransferFunction ramp;
  ramp.low = march.table.low;
  ramp.high = march.table.high;
  ramp.entries = {{0, 0, 0, all_visible ? 1.0F : 0.0F}, {1, 0, 0, 1}};
  request.classification = ramp;
}

bool needs_finish(const March& march) {
  return march.extreme || march.sum;
}

void finish_image(const March& march, volume::Image& image) {
  const volume::TransferFunction& table = march.table;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    Rgba colour{};
    // Pixels without samples hold what changes no extreme.
    const float sampled = image.rgba[i + 3];
    if (march.sum) {
      // Alpha counts samples.
      if (sampled > 0) colour = ray_of(march, {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2], 1}, 1);
    } else if (sampled > 0 && sampled <= 1) {
      colour = table_at(table, table.low + image.rgba[i] * (table.high - table.low));
    }
    std::copy(colour.begin(), colour.end(), image.rgba.begin() + std::ptrdiff_t(i));
  }
}

}  // namespace understudy::spu
