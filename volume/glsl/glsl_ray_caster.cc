// SPDX-License-Identifier: Apache-2.0
#include "volume/glsl/glsl_ray_caster.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>
#include <vector>

#include "volume/footprint.h"
#include "volume/glsl/brick_passes.h"
#include "volume/glsl/field_texture.h"
#include "volume/occlusion.h"
#include "volume/raycast/map_visibility.h"
#include "volume/raycast/occupancy_map.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/ray_setup.h"
#include "volume/raycast/transfer_table.h"
#include "volume/request.h"

namespace understudy::volume::glsl {

namespace {

using Texel4 = std::array<float, 4>;

/// Steepest table for OpenGL's filter, in units of the slope of a linear ramp over all of a volume's values.
/// With steeper ones the filter's rounding error, 1e-6 of these values on llvmpipe, would be visible.
constexpr double steepest = 8;

/// Difference between the least and the greatest value held, in units of the texel type.
double value_span(const BrickStore& store) {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  for (std::size_t b = 0; b < store.blocks(); ++b)
    if (const BrickStore::Range& range = store.ranges(b)[0]; range.low <= range.high) {
      low = std::min(low, double(range.low));
      high = std::max(high, double(range.high));
    }
  return std::max(high - low, 0.0);
}

bool changes_steeply(const BrickStore& store, const TransferTable& table, const std::vector<Rgba>& entries) {
  double change = 0;
  for (std::size_t i = 1; i < entries.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k)
      change = std::max(change, std::abs(double(entries[i][k]) - double(entries[i - 1][k])));
  return change * double(table.scale()) * value_span(store) > steepest;
}

void bind(const Functions& gl, Unit unit, GLenum target, GLuint texture) {
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + GLint(unit)));
  gl.BindTexture(target, texture);
}

void set_filter(const Functions& gl, GLenum target, GLint filter) {
  gl.TexParameteri(target, GL_TEXTURE_MIN_FILTER, filter);
  gl.TexParameteri(target, GL_TEXTURE_MAG_FILTER, filter);
  gl.TexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    gl.TexParameteri(target, axis, GL_CLAMP_TO_EDGE);
}

}  // namespace

/// Data that depends only on the classification, on whether the operator is `min`, and on whether empty bricks
/// are skipped.
struct GlslRayCaster::Prepared {
  Classification classification;
  bool keeps_clear_samples;
  bool skips;
  std::optional<TransferTable> function;
  OccupancyMap skip;
  bool steep;  ///< too steep for OpenGL's filter
  Texture distances;
  Texture table;

  Prepared(const Functions& gl, const BrickStore& store, const Classification& from, bool keeps_clear,
           bool skips_empty)
      : classification(from),
        keeps_clear_samples(keeps_clear),
        skips(skips_empty),
        function(make_function(store, from)),
        skip(occupancy_map(store)),
        steep(is_steep(store)),
        distances(gl),
        table(gl) {
    upload_distances(gl, store);
    if (!function) return;
    const std::vector<Rgba>& entries = std::get<TransferFunction>(classification).entries;
    bind(gl, Unit::table, GL_TEXTURE_1D, table.name());
    gl.TexImage1D(GL_TEXTURE_1D, 0, GL_RGBA32F, GLsizei(entries.size()), 0, GL_RGBA, GL_FLOAT, entries.data());
    set_filter(gl, GL_TEXTURE_1D, GL_LINEAR);
  }

  static std::optional<TransferTable> make_function(const BrickStore& store, const Classification& from) {
    const auto* function = std::get_if<TransferFunction>(&from);
    if (!function) return std::nullopt;
    return TransferTable(*function, store.description().type, 0.0F);
  }

  bool is_steep(const BrickStore& store) const {
    if (function) return changes_steeply(store, *function, std::get<TransferFunction>(classification).entries);
    return std::get<LinearMap>(classification).alpha_above >= 0;  // discarding is a step
  }

  OccupancyMap occupancy_map(const BrickStore& store) const {
    if (!skips) return OccupancyMap(store.block_counts(), std::vector<bool>(store.blocks(), true));
    std::vector<bool> all(store.blocks());
    for (std::size_t b = 0; b < all.size(); ++b) {
      const auto ranges = store.ranges(b);
      all[b] = keeps_clear_samples ? ranges[0].low <= ranges[0].high
               : function          ? function->shows(ranges[0])
                                   : shows(std::get<LinearMap>(classification), ranges);
    }
    return OccupancyMap(store.block_counts(), std::move(all));
  }

  void upload_distances(const Functions& gl, const BrickStore& store) const {
    const auto& counts = store.block_counts();
    bind(gl, Unit::distances, GL_TEXTURE_3D, distances.name());
    gl.TexImage3D(GL_TEXTURE_3D, 0, GL_R8UI, counts[0], counts[1], counts[2], 0, GL_RED_INTEGER,
                  GL_UNSIGNED_BYTE, skip.distances());
    set_filter(gl, GL_TEXTURE_3D, GL_NEAREST);
  }
};

/// The rays of one image, one per pixel, in the form that the shader reads.
struct GlslRayCaster::Rays {
  int width = 0;
  int height = 0;
  std::vector<Texel4> starts, steps;
  std::vector<float> ends;  ///< lengths of the last samples' layers; empty: one step each

  /// Sets up the rays of `pixels`; returns whether any has a sample.
  bool set_up(const RaySetup& setup, const RenderRequest& request, const Rect& pixels, FrameCounts& counts) {
    width = pixels.width;
    height = pixels.height;
    starts.resize(pixels.pixels());
    steps.resize(pixels.pixels());
    const bool whole_rays = request.steps && request.steps->cover_whole_ray;
    ends.resize(whole_rays ? pixels.pixels() : 0);
    tbb::combinable<FrameCounts> partial;
    const int packet_rows = (height + packet_height - 1) / packet_height;
    tbb::parallel_for(tbb::blocked_range<int>(0, packet_rows), [&](const tbb::blocked_range<int>& range) {
      FrameCounts& mine = partial.local();
      RayPacket packet;
      for (int row = range.begin(); row < range.end(); ++row)
        for (int x = 0; x < width; x += tile_width) {
          const int y = row * packet_height;
          const int columns = std::min(tile_width, width - x), rows = std::min(packet_height, height - y);
          set_up_packet(setup, request, pixels.x + x, pixels.y + y, columns, rows, packet);
          for (int j = 0; j < rows; ++j)
            for (int i = 0; i < columns; ++i) {
              const auto r = std::size_t(j) * std::size_t(tile_width) + std::size_t(i);
              const std::size_t pixel = std::size_t(y + j) * std::size_t(width) + std::size_t(x + i);
              const int first = packet.first[r], last = packet.last[r];
              starts[pixel] = {packet.start[0][r], packet.start[1][r], packet.start[2][r], float(first)};
              steps[pixel] = {packet.step[0][r], packet.step[1][r], packet.step[2][r], float(last)};
              if (whole_rays) ends[pixel] = packet.last_length[r];
              if (first > last) continue;
              ++mine.rays;
              mine.samples += std::uint64_t(last - first + 1);
            }
        }
    });
    FrameCounts all;
    partial.combine_each([&](const FrameCounts& c) { all += c; });
    counts += all;
    return all.rays > 0;
  }
};

/// Everything that lives in the context.
struct GlslRayCaster::Resources {
  // Exactly one of the two is set.
  std::optional<FieldTexture> field;
  std::optional<BrickPasses> bricks;
  Texture starts, steps, ends, image, taken;
  GLuint framebuffer = 0;
  int width = 0, height = 0;  ///< of the textures with one texel per pixel
  /// Most recent first. Two, because viewers whose framebuffer keeps alpha request two images per frame.
  std::array<std::unique_ptr<Prepared>, 2> prepared;
  Rays rays;
  std::vector<std::array<float, 2>> counted;  ///< read back from `taken`

  Resources(Device& device, const BrickStore& store, int brick_cells)
      : starts(device.gl()), steps(device.gl()), ends(device.gl()), image(device.gl()), taken(device.gl()) {
    if (FieldTexture::fits(device, store)) try {
        field.emplace(device, store);
      } catch (const OutOfMemory&) {
        // Memory may suffice for bricks.
      }
    if (!field) bricks.emplace(device, store, brick_cells);
    device.gl().GenFramebuffers(1, &framebuffer);
  }

  void resize(Device& device, int to_width, int to_height) {
    if (to_width <= width && to_height <= height) return;
    const Functions& gl = device.gl();
    width = std::max(width, to_width);
    height = std::max(height, to_height);
    const auto make = [&](const Texture& texture, GLint format, GLenum channels) {
      bind(gl, Unit::ray_starts, GL_TEXTURE_2D, texture.name());
      gl.TexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, channels, GL_FLOAT, nullptr);
      set_filter(gl, GL_TEXTURE_2D, GL_NEAREST);
    };
    make(starts, GL_RGBA32F, GL_RGBA);
    make(steps, GL_RGBA32F, GL_RGBA);
    make(ends, GL_R32F, GL_RED);
    if (bricks) return device.check("making textures for rays");  // they have images of their own
    make(image, GL_RGBA32F, GL_RGBA);
    make(taken, GL_RG32F, GL_RG);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.FramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, image.name(), 0);
    gl.FramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, taken.name(), 0);
    const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    gl.DrawBuffers(2, both);
    device.check("making textures for an image");
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      width = height = 0;
      throw NotSupported("this OpenGL does not draw into float textures");
    }
  }

  void upload_rays(const Functions& gl) {
    const auto upload = [&](Unit unit, const Texture& texture, const std::vector<Texel4>& texels) {
      bind(gl, unit, GL_TEXTURE_2D, texture.name());
      gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, rays.width, rays.height, GL_RGBA, GL_FLOAT, texels.data());
    };
    upload(Unit::ray_starts, starts, rays.starts);
    upload(Unit::ray_steps, steps, rays.steps);
    if (rays.ends.empty()) return;
    bind(gl, Unit::ray_ends, GL_TEXTURE_2D, ends.name());
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, rays.width, rays.height, GL_RED, GL_FLOAT, rays.ends.data());
  }

  void count_walked(FrameCounts& counts) const {
    for (const std::array<float, 4>& ray : bricks->progress()) {
      counts.samples_taken += std::uint64_t(std::abs(ray[1]));
      counts.rays_terminated += ray[1] < 0 ? 1 : 0;
      counts.samples_hidden += std::uint64_t(ray[3]);
    }
  }

  void read_counts(const Functions& gl, FrameCounts& counts) {
    counted.resize(std::size_t(rays.width) * std::size_t(rays.height));
    gl.ReadBuffer(GL_COLOR_ATTACHMENT1);
    gl.ReadPixels(0, 0, rays.width, rays.height, GL_RG, GL_FLOAT, counted.data());
    for (const auto& [samples, hidden] : counted) {
      counts.samples_taken += std::uint64_t(std::abs(samples));
      counts.rays_terminated += samples < 0 ? 1 : 0;
      counts.samples_hidden += std::uint64_t(hidden);
    }
  }
};

GlslRayCaster::GlslRayCaster(const BrickStore& store, Device& device, int brick_cells)
    : store_(store), device_(device), brick_cells_(brick_cells) {}

GlslRayCaster::~GlslRayCaster() {
  if (!resources_) return;
  try {
    const Device::Current current(device_);
    device_.gl().DeleteFramebuffers(1, &resources_->framebuffer);
    resources_.reset();
  } catch (const std::exception&) {
    // A context that cannot be made current has already lost its textures.
  }
}

std::optional<std::string> GlslRayCaster::obstacle(const RenderRequest& request) const {
  if (std::holds_alternative<PreIntegrationTable>(request.classification))
    return "segments with a pre-integration table";
  if (request.fog) return "fog";
  if (request.filter == Filter::linear_8_bit) return "a linear filter of 8 bits";
  if (request.method == Method::pre_integrated) return "pre-integrated segments";
  if (request.method == Method::adaptive) return "adaptive steps";
  if (!request.surfaces.empty()) return "surfaces";
  if (request.light) return "light";
  if (const auto* function = std::get_if<TransferFunction>(&request.classification);
      function && function->entries.size() > std::size_t(device_.max_texture_edge()))
    return fmt::format("a transfer function of {} entries, where textures take {}", function->entries.size(),
                       device_.max_texture_edge());
  if (std::max(request.window.width, request.window.height) > device_.max_texture_edge())
    return fmt::format("an image of {} x {} pixels, where textures take {}", request.window.width,
                       request.window.height, device_.max_texture_edge());
  return std::nullopt;
}

BrickFigures GlslRayCaster::brick_figures() const {
  if (!resources_ || !resources_->bricks) return {};
  const BrickPasses& passes = *resources_->bricks;
  const BrickAtlas& atlas = passes.atlas();
  return {atlas.grid().bricks(), atlas.slots(), passes.passes(), atlas.uploads(), atlas.evictions()};
}

std::vector<std::size_t> GlslRayCaster::visible_bricks(const RenderRequest& request, const Prepared& prepared,
                                                       const Rect& pixels) const {
  const BrickGrid& grid = resources_->bricks->atlas().grid();
  const auto& counts = store_.block_counts();
  const int blocks_along = grid.edge / BrickStore::block_cells;
  std::vector<bool> shows(grid.bricks());
  std::size_t block = 0;
  for (int z = 0; z < counts[2]; ++z)
    for (int y = 0; y < counts[1]; ++y)
      for (int x = 0; x < counts[0]; ++x, ++block) {
        if (!prepared.skip.shows(block)) continue;
        const std::size_t row =
            std::size_t(z / blocks_along) * std::size_t(grid.counts[1]) + std::size_t(y / blocks_along);
        shows[row * std::size_t(grid.counts[0]) + std::size_t(x / blocks_along)] = true;
      }
  std::vector<std::size_t> visible;
  for (const std::size_t brick : grid.in_visibility_order(store_.description(), request)) {
    if (!shows[brick]) continue;
    if (!intersection(footprint(request, store_.description(), grid.cells(brick)), pixels).empty())
      visible.push_back(brick);
  }
  return visible;
}

void GlslRayCaster::blocks_changed(std::span<const std::size_t> blocks) {
  if (resources_) changed_.insert(changed_.end(), blocks.begin(), blocks.end());
}

void GlslRayCaster::set_uniforms(const MarchProgram& program, const RenderRequest& request,
                                 const Prepared& prepared, const std::array<float, 3>& top,
                                 const std::array<float, 3>& rounding) const {
  const Functions& gl = device_.gl();
  const double unit = largest_texel(store_.description().type);
  gl.UseProgram(program.name);
  std::array<float, 3> scale{}, origin{}, has_border{};
  const auto& size = resources_->field ? resources_->field->size() : resources_->bricks->atlas().size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    scale[axis] = 1.0F / float(size[axis]);
    origin[axis] = float(store_.first_block()[axis] * BrickStore::block_cells);
    has_border[axis] = store_.description().wrap[axis] == Wrap::border ? 1.0F : 0.0F;
  }
  gl.Uniform3fv(program.texture_origin, 1, origin.data());
  gl.Uniform3fv(program.texture_scale, 1, scale.data());
  gl.Uniform3iv(program.first_block, 1, store_.first_block().data());
  gl.Uniform3fv(program.top, 1, top.data());
  gl.Uniform3fv(program.rounding, 1, rounding.data());
  gl.Uniform3fv(program.has_border, 1, has_border.data());
  Rgba border = store_.border();
  for (float& component : border) component = float(component / unit);
  gl.Uniform4fv(program.border, 1, border.data());
  gl.Uniform1f(program.termination, least_transparency(request));
  gl.Uniform1f(program.opacity_limit, request.opacity_limit);
  gl.Uniform1f(program.brick_cells, float(brick_cells_));
  if (prepared.function) {
    const TransferTable& table = *prepared.function;
    gl.Uniform1f(program.table_low, float(table.low() / unit));
    gl.Uniform1f(program.table_scale,
                 float(std::min(table.scale() * unit, double(std::numeric_limits<float>::max()))));
    gl.Uniform1f(program.table_last, table.last());
  } else {
    const auto& map = std::get<LinearMap>(prepared.classification);
    gl.UniformMatrix4fv(program.map, 1, GL_TRUE, map.matrix.data());
    gl.Uniform1f(program.multiply_by_alpha, map.multiply_by_alpha ? 1.0F : 0.0F);
    gl.Uniform1f(program.alpha_above, map.alpha_above);
  }
}

void GlslRayCaster::draw(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) {
  draw_all(request, out, counts);
  if (occlusion != nullptr && can_occlude(request)) cover_opaque_tiles(out, request, *occlusion);
}

void GlslRayCaster::check_drawable(const RenderRequest& request, const Image& out) const {
  if (!store_.finished()) throw std::logic_error("rendering a volume whose slices have not all arrived");
  validate(store_.description(), request);
  if (const auto reason = obstacle(request))
    throw NotSupported(fmt::format("not supported by the GL backend: {}", *reason));
  if (out.rgba.size() != 4 * out.rect.pixels())
    throw std::invalid_argument(fmt::format("an image of {} x {} pixels with {} values", out.rect.width,
                                            out.rect.height, out.rgba.size()));
}

void GlslRayCaster::follow_changes(Resources& here) {
  if (changed_.empty()) return;
  if (here.field)
    here.field->blocks_changed(changed_);
  else
    here.bricks->atlas().blocks_changed(changed_);
  for (const auto& prepared : here.prepared)
    if (prepared) {
      prepared->skip = prepared->occupancy_map(store_);
      prepared->steep = prepared->is_steep(store_);
      prepared->upload_distances(device_.gl(), store_);
    }
  changed_.clear();
}

const GlslRayCaster::Prepared& GlslRayCaster::prepared_for(const RenderRequest& request, Resources& here) {
  const bool keeps_clear_samples = request.op == Operator::min;
  const auto fits = [&](const std::unique_ptr<Prepared>& prepared) {
    return prepared && prepared->keeps_clear_samples == keeps_clear_samples &&
           prepared->skips == request.optimizations.empty_bricks &&
           prepared->classification == request.classification;
  };
  if (!fits(here.prepared[0])) here.prepared[0].swap(here.prepared[1]);
  if (!fits(here.prepared[0]))
    here.prepared[0] = std::make_unique<Prepared>(device_.gl(), store_, request.classification,
                                                  keeps_clear_samples, request.optimizations.empty_bricks);
  return *here.prepared[0];
}

const MarchProgram& GlslRayCaster::program_for(const RenderRequest& request, const Prepared& prepared,
                                               const Resources& here) {
  const auto& wrap = store_.description().wrap;
  MarchVariant variant;
  variant.colours = store_.description().type == TexelType::rgba8;
  variant.bordered =
      request.filter == Filter::linear && std::find(wrap.begin(), wrap.end(), Wrap::border) != wrap.end();
  variant.filter = request.filter;
  variant.op = request.op;
  variant.own_filter = prepared.steep;
  variant.bricked = here.bricks.has_value();
  variant.whole_rays = request.steps && request.steps->cover_whole_ray;
  return device_.program(variant);
}

void GlslRayCaster::draw_whole(const Rect& pixels, Image& out, FrameCounts& counts, Resources& here) const {
  const Functions& gl = device_.gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, here.framebuffer);
  gl.Viewport(0, 0, pixels.width, pixels.height);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);

  gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl.PixelStorei(GL_PACK_ROW_LENGTH, out.rect.width);
  gl.ReadPixels(0, 0, pixels.width, pixels.height, GL_RGBA, GL_FLOAT, out.at(pixels.x, pixels.y));
  gl.PixelStorei(GL_PACK_ROW_LENGTH, 0);
  here.read_counts(gl, counts);
  device_.check("drawing the volume");
}

void GlslRayCaster::draw_all(const RenderRequest& request, Image& out, FrameCounts& counts) {
  check_drawable(request, out);
  std::fill(out.rgba.begin(), out.rgba.end(), neutral_value(request.op));
  if (store_.empty()) return;

  const Device::Current current(device_);
  const Functions& gl = device_.gl();
  if (!resources_) resources_ = std::make_unique<Resources>(device_, store_, brick_cells_);
  Resources& here = *resources_;
  follow_changes(here);
  const Prepared& prepared = prepared_for(request, here);
  FrameCounts mine;  // not added if drawing fails: the CPU counts then
  mine.blocks = store_.blocks();
  mine.blocks_empty = prepared.skip.empty_bricks();

  const Rect pixels = intersection(out.rect, intersection(request.window, request.viewport));
  const bool any_sample = !pixels.empty() && (request.steps || request.planes.count > 0);
  const RaySetup setup(request, store_);
  if (!any_sample || !here.rays.set_up(setup, request, pixels, mine)) {
    counts += mine;
    return;
  }

  here.resize(device_, pixels.width, pixels.height);
  here.upload_rays(gl);
  if (here.field) bind(gl, Unit::field, GL_TEXTURE_3D, here.field->name());
  bind(gl, Unit::distances, GL_TEXTURE_3D, prepared.distances.name());
  bind(gl, Unit::table, GL_TEXTURE_1D, prepared.table.name());
  const MarchProgram& program = program_for(request, prepared, here);
  set_uniforms(program, request, prepared, setup.top, setup.rounding);
  if (!here.bricks) {
    draw_whole(pixels, out, mine, here);
  } else if (std::vector<std::size_t> visible = visible_bricks(request, prepared, pixels); !visible.empty()) {
    here.bricks->draw(program, pixels.width, pixels.height, std::move(visible));
    here.bricks->read_image(out.rect.width, out.at(pixels.x, pixels.y));
    here.count_walked(mine);
    device_.check("reading the image");
  }
  counts += mine;
}

}  // namespace understudy::volume::glsl
