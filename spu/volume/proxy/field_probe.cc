// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/field_probe.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "spu/volume/context/context.h"
#include "volume/matrix.h"

namespace understudy::spu {
namespace {

constexpr int finest_viewport = 4096;
constexpr int most_ramp_texels = 2048;

std::array<GLint, 4> rectangle(const DispatchTable& gl, GLenum name) {
  std::array<GLint, 4> value{};
  gl.GetIntegerv(name, value.data());
  return value;
}

}  // namespace

bool is_depth_texture(const DispatchTable& gl, const SampledTexture& texture) {
  if (texture.target != GL_TEXTURE_2D || texture.texture == 0) return false;
  GLint active = 0;
  GLint bits = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + texture.unit));
  gl.GetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_DEPTH_SIZE, &bits);
  gl.ActiveTexture(GLenum(active));
  return bits > 0;
}

bool may_be_sampled_by(const DispatchTable& gl, GLuint program, const std::string& sampler,
                       const SampledTexture& texture) {
  const bool known = !sampler.empty() && sampler.find('*') == std::string::npos;
  return !known || gl.GetUniformLocation(program, sampler.c_str()) == texture.sampler_location;
}

std::vector<SampledTexture> gradient_tables(const MarchContext& measured) {
  const Pipeline& pipeline = measured.run.pipeline();
  std::vector<SampledTexture> tables;
  for (const std::string& name : measured.tables_of_gradients) {
    const GLint location = measured.context.gl->GetUniformLocation(pipeline.program, name.c_str());
    const auto table = std::ranges::find(pipeline.others, location, &SampledTexture::sampler_location);
    if (table != pipeline.others.end() && (table->target == GL_TEXTURE_1D || table->target == GL_TEXTURE_2D))
      tables.push_back(*table);
  }
  return tables;
}

FieldProbe::FieldProbe(const MarchContext& measured)
    : gl_(*measured.context.gl),
      run_(measured.run),
      texture_(measured.texture),
      with_swizzle_(measured.context.version >= 330),
      viewport_(rectangle(gl_, GL_VIEWPORT)),
      scissor_(rectangle(gl_, GL_SCISSOR_BOX)),
      saved_(measured.context),
      lifted_(measured.context, measured.run.pipeline().program) {
  gl_.GetIntegerv(GL_MAX_VIEWPORT_DIMS, largest_viewport_.data());
  GLint longest = 0;
  gl_.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &longest);
  ramp_texels_ = std::clamp(longest, field_texels, most_ramp_texels);
  fine_ = std::min({finest_viewport, int(largest_viewport_[0]), int(largest_viewport_[1])});
  const volume::Rect all{viewport_[0], viewport_[1], viewport_[2], viewport_[3]};
  free_ = measured.kept ? intersection(all, *measured.kept) : all;
  const int width = std::max(1, viewport_[0] + viewport_[2]);
  const int height = std::max(1, viewport_[1] + viewport_[3]);

  const Pipeline& pipeline = run_.pipeline();
  for (const SampledTexture& other : pipeline.others) {
    if (!is_depth_texture(gl_, other)) continue;
    saved_.borrow_texture(GL_TEXTURE_2D, other.unit);
    // Of the same size: some programs fetch texels by fragment position.
    std::array<GLint, 2> size{};
    gl_.GetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_WIDTH, &size[0]);
    gl_.GetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_HEIGHT, &size[1]);
    measured.surfaces.bind_far_plane(size[0], size[1]);
  }
  saved_.borrow_texture(GL_TEXTURE_3D, pipeline.volume.unit);

  gradient_tables_ = gradient_tables(measured);
  show_white_gradient_tables();

  complete_ = measured.surfaces.bind_framebuffer(width, height) != 0;
  // The application chooses which faces of the box produce fragments. If all do, the nearest counts.
  gl_.Enable(saved_.was_enabled(GL_CULL_FACE) ? GL_CULL_FACE : GL_DEPTH_TEST);
  gl_.GetIntegerv(GL_DEPTH_FUNC, &depth_function_);
  gl_.DepthFunc(GL_LESS);
  gl_.DepthMask(GL_TRUE);
  gl_.Enable(GL_SCISSOR_TEST);
}

FieldProbe::~FieldProbe() {
  gl_.Scissor(scissor_[0], scissor_[1], scissor_[2], scissor_[3]);
  gl_.DepthFunc(GLenum(depth_function_));
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_CULL_FACE);
  gl_.Disable(GL_SCISSOR_TEST);
  gl_.DeleteTextures(GLsizei(textures_.size()), textures_.data());
}

/// Whether texels of the volume's own 8-bit type can hold all of these. Drivers may convert bytes to values
/// that differ from multiples of 1/255 in the last bit, which changes the result of programs that compare a
/// sample with one.
bool FieldProbe::of_bytes(std::span<const float> texels) const {
  constexpr float bytes = 255;
  return texture_.type == volume::TexelType::u8 && std::ranges::all_of(texels, [](float value) {
           return std::abs(value - std::round(value * bytes) / bytes) < 1e-6F && value >= 0 && value <= 1;
         });
}

void FieldProbe::show(const std::array<float, 8>& corners) {
  show(corners, {2, 2, 2}, GL_LINEAR);
}

void FieldProbe::show(std::span<const float> texels, const std::array<int, 3>& size, GLint filter) {
  // A new texture for every field: changing one that is in use would wait for the draw.
  GLuint name = 0;
  gl_.ActiveTexture(GLenum(GL_TEXTURE0 + run_.pipeline().volume.unit));
  gl_.GenTextures(1, &name);
  textures_.push_back(name);
  gl_.BindTexture(GL_TEXTURE_3D, name);
  gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
  gl_.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, filter);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
    gl_.TexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
  }
  if (with_swizzle_) gl_.TexParameteriv(GL_TEXTURE_3D, GL_TEXTURE_SWIZZLE_RGBA, texture_.swizzle.data());
  const GLenum format = of_bytes(texels) ? byte_probe_format(texture_.base) : probe_format(texture_.base);
  gl_.TexImage3D(GL_TEXTURE_3D, 0, GLint(format), size[0], size[1], size[2], 0, upload_format(texture_.base),
                 GL_FLOAT, texels.data());
}

std::vector<volume::Rgba> FieldProbe::at(double x, double y, std::span<const float> values) {
  return at_slope(x, y, values, 0);
}

void FieldProbe::remove(const ShaderBackground& background, std::vector<CountedPlace> rays) {
  background_ = background;
  counted_ = std::move(rays);
  contrasts_.clear();
}

void FieldProbe::learn_contrasts(std::span<const float> values) {
  std::vector<float> unknown;
  for (const float value : values) {
    if (contrasts_.try_emplace(value).second) unknown.push_back(value);
  }
  if (unknown.empty()) return;
  std::vector<double> samples;
  std::vector<std::vector<volume::Vec3>> differences(unknown.size());
  for (const CountedPlace& ray : counted_) {
    samples.push_back(ray.samples);
    const std::vector<volume::Rgba> fragments = drawn_at(ray.x, ray.y, unknown, 0);
    for (std::size_t i = 0; i < unknown.size(); ++i)
      differences[i].push_back(volume::subtract(colour_of(fragments[i]), background_->colour));
  }
  for (std::size_t i = 0; i < unknown.size(); ++i)
    contrasts_[unknown[i]] = contrast_of(samples, differences[i]);
}

void FieldProbe::remove_from(std::span<volume::Rgba> fragments, float value, float other) {
  const std::array both{value, other};
  learn_contrasts(both);
  const BackgroundContrast& first = contrasts_[value];
  const BackgroundContrast& second = contrasts_[other];
  for (volume::Rgba& fragment : fragments) {
    if (fragment[3] == no_fragment) continue;
    const volume::Vec3 difference = volume::subtract(colour_of(fragment), background_->colour);
    const auto opacity = value == other ? opacity_of(first, difference) : opacity_of(first, second, difference);
    fragment =
        opacity ? without_background(*background_, *opacity, fragment) : volume::Rgba{0, 0, 0, no_fragment};
  }
}

std::vector<volume::Rgba> FieldProbe::at_slope(double x, double y, std::span<const float> values, float rise) {
  std::vector<volume::Rgba> fragments = drawn_at(x, y, values, rise);
  if (!background_) return fragments;
  learn_contrasts(values);
  for (std::size_t i = 0; i < values.size(); ++i) remove_from({&fragments[i], 1}, values[i], values[i]);
  return fragments;
}

std::vector<volume::Rgba> FieldProbe::drawn_at(double x, double y, std::span<const float> values, float rise) {
  return drawn_at(x, y, values.size(), [&](std::size_t i) {
    std::array<float, 8> corners;
    for (std::size_t c = 0; c < 8; ++c) {
      const float height = float(c & 1) + float(c >> 1 & 1) + float(c >> 2 & 1);
      corners[c] = values[i] + rise * (height / 3 - 0.5F);
    }
    show(corners);
  });
}

FieldProbe::Heights FieldProbe::heights_of(const EvenSlope& slope) {
  Heights heights{slope, {}, {}};
  std::array<int, 3>& size = heights.size;
  for (std::size_t axis = 0; axis < 3; ++axis) size[axis] = slope.gradient[axis] == 0 ? 1 : slope.texels[axis];
  const auto height = [&](std::size_t axis, int i) {
    return slope.gradient[axis] * ((i + 0.5) / size[axis] - slope.place[axis]);
  };
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i)
        heights.texels.push_back(float(height(0, i) + height(1, j) + height(2, k)));
    }
  }
  return heights;
}

std::vector<volume::Rgba> FieldProbe::at_slopes(double x, double y, std::span<const SlopedField> fields) {
  std::optional<Heights> heights;
  std::vector<float> texels;
  std::vector<volume::Rgba> shown = drawn_at(x, y, fields.size(), [&](std::size_t f) {
    const SlopedField& field = fields[f];
    for (const PlainTable& table : field.tables) show_plain(table);
    if (!heights || heights->slope != field.slope) heights = heights_of(field.slope);
    texels.resize(heights->texels.size());
    std::ranges::transform(heights->texels, texels.begin(),
                           [&](float height) { return field.value + field.steepness * height; });
    show(texels, heights->size, GL_LINEAR);
  });
  for (const SlopedField& field : fields) {
    for (const PlainTable& table : field.tables) show_own(table.texture);
  }
  return shown;
}

std::vector<volume::Rgba> FieldProbe::at_stripes(double x, double y, std::span<const StripedField> fields) {
  std::vector<volume::Rgba> shown = drawn_at(x, y, fields.size(), [&](std::size_t f) {
    const StripedField& field = fields[f];
    for (const PlainTable& table : field.tables) show_plain(table);
    std::array<int, 3> size{1, 1, 1};
    size[field.axis] = field_texels;
    std::vector<float> texels;
    texels.reserve(field_texels);
    for (int i = 0; i < field_texels; ++i)
      texels.push_back(field.values[std::size_t((i + field.begin) / field.width % 2)]);
    show(texels, size, GL_NEAREST);
  });
  for (const StripedField& field : fields) {
    for (const PlainTable& table : field.tables) show_own(table.texture);
  }
  return shown;
}

std::vector<volume::Rgba> FieldProbe::at_layer(double x, double y, const Layer& layer,
                                               std::span<const float> values) {
  std::array<int, 3> size{1, 1, 1};
  size[layer.axis] = ramp_texels_;
  const auto first = std::clamp(std::lround(layer.low * ramp_texels_), 0L, long{ramp_texels_});
  const auto end = std::clamp(std::lround(layer.high * ramp_texels_), first, long{ramp_texels_});
  return drawn_at(x, y, values.size(), [&](std::size_t i) {
    std::vector<float> texels(std::size_t(ramp_texels_), layer.outside);
    std::fill(texels.begin() + first, texels.begin() + end, values[i]);
    show(texels, size, GL_NEAREST);
  });
}

std::array<double, 2> FieldProbe::middle_of_pixel_at(double x, double y) const {
  const auto middle = [&](double place) {
    return 2 * (std::clamp(std::floor((place + 1) / 2 * fine_), 0.0, double(fine_ - 1)) + 0.5) / fine_ - 1;
  };
  return {middle(x), middle(y)};
}

std::vector<volume::Rgba> FieldProbe::drawn_at(double x, double y, std::size_t wanted,
                                               const std::function<void(std::size_t)>& show_field) {
  // Every draw puts its one pixel to a place of its own, so that one read returns them all.
  const int px = std::clamp(int(std::floor((x + 1) / 2 * fine_)), 0, fine_ - 1);
  const int py = std::clamp(int(std::floor((y + 1) / 2 * fine_)), 0, fine_ - 1);
  const int columns = std::max(1, free_.width);
  const int most_rows = std::max(1, free_.height);
  const int left = free_.x;
  const int bottom = free_.y;
  std::vector<volume::Rgba> colours;
  while (colours.size() < wanted) {
    const std::size_t count = std::min(std::size_t(columns) * std::size_t(most_rows), wanted - colours.size());
    const int rows = (int(count) + columns - 1) / columns;
    const std::size_t kept = textures_.size();
    gl_.Scissor(left, bottom, columns, rows);
    clear();
    for (std::size_t i = 0; i < count; ++i) {
      const int column = left + int(i) % columns;
      const int row = bottom + int(i) / columns;
      show_field(colours.size() + i);
      gl_.Viewport(column - px, row - py, fine_, fine_);
      gl_.Scissor(column, row, 1, 1);
      run_.replay(gl_);
    }
    std::vector<volume::Rgba> read_back(std::size_t(columns) * std::size_t(rows));
    gl_.ReadPixels(left, bottom, columns, rows, GL_RGBA, GL_FLOAT, read_back.data());
    colours.insert(colours.end(), read_back.begin(), read_back.begin() + std::ptrdiff_t(count));
    // Delete the textures of these fields; there may be hundreds.
    gl_.DeleteTextures(GLsizei(textures_.size() - kept), textures_.data() + kept);
    textures_.resize(kept);
  }
  return colours;
}

std::vector<volume::Rgba> FieldProbe::sums_at(double x, double y, std::span<const float> values) {
  if (culls_faces()) return {};
  gl_.Disable(GL_DEPTH_TEST);
  gl_.BlendEquation(GL_FUNC_ADD);
  gl_.BlendFunc(GL_ONE, GL_ONE);
  gl_.Enable(GL_BLEND);
  std::vector<volume::Rgba> sums = at(x, y, values);
  gl_.Disable(GL_BLEND);
  gl_.Enable(GL_DEPTH_TEST);
  for (volume::Rgba& sum : sums) sum[3] -= no_fragment;  // the clear value, which each sum contains
  return sums;
}

/// Binds a new texture in place of `texture`, unfiltered and repeating.
void FieldProbe::bind_in_place_of(const SampledTexture& texture) {
  const BorrowedTexture place{texture.target, texture.unit};
  if (std::ranges::find(borrowed_, place) == borrowed_.end()) {
    saved_.borrow_texture(texture.target, texture.unit);
    borrowed_.push_back(place);
  }
  GLuint name = 0;
  gl_.ActiveTexture(GLenum(GL_TEXTURE0 + texture.unit));
  gl_.GenTextures(1, &name);
  textures_.push_back(name);
  gl_.BindTexture(texture.target, name);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl_.TexParameteri(texture.target, filter, GL_NEAREST);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl_.TexParameteri(texture.target, axis, GL_REPEAT);
}

void FieldProbe::show_plain(const PlainTable& table) {
  bind_in_place_of(table.texture);
  if (table.texture.target == GL_TEXTURE_1D)
    gl_.TexImage1D(GL_TEXTURE_1D, 0, GL_RGBA32F, 1, 0, GL_RGBA, GL_FLOAT, table.colour.data());
  else
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 1, 1, 0, GL_RGBA, GL_FLOAT, table.colour.data());
}

void FieldProbe::show_coordinate(const SampledTexture& texture) {
  constexpr GLsizei width = 2048;
  bind_in_place_of(texture);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl_.TexParameteri(texture.target, filter, GL_LINEAR);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl_.TexParameteri(texture.target, axis, GL_CLAMP_TO_EDGE);
  std::vector<float> colours;
  colours.reserve(4 * std::size_t(width));
  // The first and the last texel hold 0 and 1.
  for (int i = 0; i < width; ++i) {
    const float coordinate = i == 0 ? 0 : i == width - 1 ? 1 : (float(i) + 0.5F) / float(width);
    colours.insert(colours.end(), 4, coordinate);
  }
  if (texture.target == GL_TEXTURE_1D)
    gl_.TexImage1D(GL_TEXTURE_1D, 0, GL_RGBA32F, width, 0, GL_RGBA, GL_FLOAT, colours.data());
  else
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, 1, 0, GL_RGBA, GL_FLOAT, colours.data());
}

void FieldProbe::show_instead(const SampledTexture& texture, int width, int height,
                              std::span<const float> texels) {
  bind_in_place_of(texture);
  // The same scalar in every component, whichever one the program reads.
  std::vector<float> colours;
  colours.reserve(4 * texels.size());
  for (const float number : texels) colours.insert(colours.end(), 4, number);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, colours.data());
}

void FieldProbe::show_white_gradient_tables() {
  for (const SampledTexture& table : gradient_tables_) show_plain({table, {1, 1, 1, 1}});
}

void FieldProbe::show_own_gradient_tables() {
  for (const SampledTexture& table : gradient_tables_) give_back(table);
}

void FieldProbe::show_own(const SampledTexture& texture) {
  const auto same = [&](const SampledTexture& table) {
    return table.target == texture.target && table.unit == texture.unit;
  };
  if (std::ranges::any_of(gradient_tables_, same))
    show_plain({texture, {1, 1, 1, 1}});
  else
    give_back(texture);
}

void FieldProbe::give_back(const SampledTexture& texture) {
  if (std::erase(borrowed_, BorrowedTexture{texture.target, texture.unit}) == 0) return;
  // With its sampler object: the texture's own filter may need mipmap levels that it does not have.
  saved_.give_back_texture(texture.target, texture.unit);
}

void FieldProbe::clear() {
  constexpr std::array<float, 4> nothing{0, 0, 0, no_fragment};
  gl_.ClearBufferfv(GL_COLOR, 0, nothing.data());
  constexpr float farthest = 1;
  gl_.ClearBufferfv(GL_DEPTH, 0, &farthest);
}

std::vector<volume::Rgba> FieldProbe::pixels(const volume::Rect& part, float value) {
  show({value, value, value, value, value, value, value, value});
  std::vector<volume::Rgba> fragments = in_place(part.x, part.y, part.width, part.height);
  if (background_) remove_from(fragments, value, value);
  return fragments;
}

void FieldProbe::show(const SplitField& field) {
  std::array<int, 3> size{1, 1, 1};
  size[field.axis] = field_texels;
  std::vector<float> texels(field_texels, field.behind);
  const auto plane = std::clamp(std::lround(field.plane / split_unit), 0L, long{field_texels});
  std::fill_n(texels.begin(), plane, field.before);
  show(texels, size, GL_NEAREST);
}

std::vector<volume::Rgba> FieldProbe::pixels(const volume::Rect& part, const SplitField& field) {
  show(field);
  std::vector<volume::Rgba> fragments = in_place(part.x, part.y, part.width, part.height);
  if (background_) remove_from(fragments, field.before, field.behind);
  return fragments;
}

std::vector<volume::Rgba> FieldProbe::rows(int first_row, int rows, const RampField& field) {
  std::array<int, 3> size{1, 1, 1};
  size[field.axis] = ramp_texels_;
  std::vector<float> texels;
  texels.reserve(std::size_t(ramp_texels_));
  for (int i = 0; i < ramp_texels_; ++i)
    texels.push_back(field.from + (field.to - field.from) * (float(i) + 0.5F) / float(ramp_texels_));
  show(texels, size, GL_LINEAR);
  return in_place(0, first_row, viewport_[2], rows);
}

std::vector<volume::Rgba> FieldProbe::rows(int first_row, int rows, const LayerField& field) {
  std::array<int, 3> size{1, 1, 1};
  size[field.axis] = ramp_texels_;
  std::vector<float> texels(std::size_t(ramp_texels_), field.outside);
  texels[std::size_t(std::clamp(int(field.place * ramp_texels_), 0, ramp_texels_ - 1))] = field.within;
  show(texels, size, GL_NEAREST);
  return in_place(0, first_row, viewport_[2], rows);
}

volume::Rgba FieldProbe::pixel(int column, int row, float value) {
  show({value, value, value, value, value, value, value, value});
  std::vector<volume::Rgba> fragments = in_place(column, row, 1, 1);
  if (background_) remove_from(fragments, value, value);
  return fragments.front();
}

volume::Rgba FieldProbe::pixel(int column, int row, const SplitField& field) {
  show(field);
  std::vector<volume::Rgba> fragments = in_place(column, row, 1, 1);
  if (background_) remove_from(fragments, field.before, field.behind);
  return fragments.front();
}

std::vector<bool> FieldProbe::kept_in(const volume::Rect& pixels, const volume::Rect& viewport, float value) {
  show({value, value, value, value, value, value, value, value});
  std::vector<bool> kept;
  for (const volume::Rgba& fragment : drawn_into(viewport, pixels)) kept.push_back(fragment[3] != no_fragment);
  return kept;
}

std::vector<volume::Rgba> FieldProbe::in_place(int column, int row, int width, int height) {
  // At their own positions, so that everything that depends on a fragment's position is as in the real draw.
  return drawn_into({viewport_[0], viewport_[1], viewport_[2], viewport_[3]}, {column, row, width, height});
}

std::vector<volume::Rgba> FieldProbe::drawn_into(const volume::Rect& viewport, const volume::Rect& pixels) {
  const int x = viewport_[0] + pixels.x;
  const int y = viewport_[1] + pixels.y;
  gl_.Viewport(viewport.x, viewport.y, viewport.width, viewport.height);
  gl_.Scissor(x, y, pixels.width, pixels.height);
  clear();
  run_.replay(gl_);
  std::vector<volume::Rgba> colours(pixels.pixels());
  gl_.ReadPixels(x, y, pixels.width, pixels.height, GL_RGBA, GL_FLOAT, colours.data());
  return colours;
}

}  // namespace understudy::spu
