// SPDX-License-Identifier: Apache-2.0
// Repeats the application's own draw over known fields: its volume is replaced by one of known values, its
// depth texture by the far plane, its framebuffer by a float one, and its cuts are lifted. The destructor
// restores everything. If the box's faces are not culled, a pixel shows its nearest fragment, whatever the
// faces' order.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spu/volume/context/saved_state.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/proxy/background_removal.h"
#include "spu/volume/proxy/coordinate_space.h"
#include "spu/volume/proxy/cuts.h"
#include "spu/volume/proxy/probe_surfaces.h"
#include "spu/volume/texture/texels.h"
#include "volume/classification.h"
#include "volume/image.h"

namespace understudy::spu {

/// The alpha of a pixel that no fragment reached.
constexpr float no_fragment = -1;

class FieldProbe {
 public:
  /// Makes tables that are looked up by gradients white, until other calls replace them.
  explicit FieldProbe(const MarchContext& measured);
  ~FieldProbe();
  FieldProbe(const FieldProbe&) = delete;
  FieldProbe& operator=(const FieldProbe&) = delete;

  /// Whether the driver offers a float framebuffer. If not, nothing may be drawn.
  bool complete() const { return complete_; }

  /// From now on at(), at_slope(), pixel() and pixels() return what a fragment's samples show without
  /// `background`, premultiplied. Contrasts that are not known yet are measured on `rays`. Where the contrasts
  /// of a split field's two values cannot be told apart, pixels count as having no fragment.
  void remove(const ShaderBackground& background, std::vector<CountedPlace> rays);

  /// Returns the fragments of the ray at normalised device coordinates (x, y), over a constant field of each
  /// value.
  std::vector<volume::Rgba> at(double x, double y, std::span<const float> values);

  /// Likewise, over fields that rise by `rise` through the volume and have the value in its middle.
  std::vector<volume::Rgba> at_slope(double x, double y, std::span<const float> values, float rise);

  /// Likewise, over linear fields, which are constant within half a texel of the faces. Backgrounds are not
  /// removed.
  struct EvenSlope {
    volume::Vec3 gradient{};
    volume::Vec3 place{};                ///< where the field has its value
    std::array<int, 3> texels{2, 2, 2};  ///< 1 is used along an axis on which the field does not rise

    bool operator==(const EvenSlope&) const = default;
  };
  /// A colour that the program reads from one of its textures, a table of 1 or 2 dimensions, at any coordinate.
  struct PlainTable {
    SampledTexture texture;
    volume::Rgba colour{};
  };
  struct SlopedField {
    float value = 0;      ///< at the slope's place
    float steepness = 1;  ///< times the slope's gradient
    EvenSlope slope{};
    std::span<const PlainTable> tables{};  ///< other tables remain the program's own
  };
  std::vector<volume::Rgba> at_slopes(double x, double y, std::span<const SlopedField> fields);

  /// Likewise, over fields that alternate between two values along the texture coordinate `axis`.
  struct StripedField {
    std::size_t axis = 0;
    int width = 1;  ///< of a stripe, in multiples of split_unit
    int begin = 0;  ///< shift of the stripes, likewise
    std::array<float, 2> values{};
    std::span<const PlainTable> tables{};
  };
  std::vector<volume::Rgba> at_stripes(double x, double y, std::span<const StripedField> fields);

  /// Likewise, over fields that have the value in a layer perpendicular to the texture coordinate `axis`, and
  /// `outside` elsewhere.
  struct Layer {
    std::size_t axis = 0;
    double low = 0;
    double high = 1;
    float outside = 0;
  };
  std::vector<volume::Rgba> at_layer(double x, double y, const Layer& layer, std::span<const float> values);

  /// Texels along the axis of a ramp, and of other fields that are to be as fine as possible.
  int finest_texels() const { return ramp_texels_; }

  /// The middle of the pixel that at() draws for (x, y), in normalised device coordinates.
  std::array<double, 2> middle_of_pixel_at(double x, double y) const;

  bool culls_faces() const { return saved_.was_enabled(GL_CULL_FACE); }

  /// As at(), but with the sum of all fragments of a pixel instead of the nearest one; empty if faces are
  /// culled.
  std::vector<volume::Rgba> sums_at(double x, double y, std::span<const float> values);

  /// Returns the fragments of these pixels of the application's viewport, row by row, over a field of `value`.
  std::vector<volume::Rgba> pixels(const volume::Rect& part, float value);

  /// Likewise, over a field that is `before` where the texture coordinate `axis` is less than `plane`, and
  /// `behind` beyond.
  struct SplitField {
    std::size_t axis = 0;
    double plane = 0.5;  ///< a multiple of split_unit; outside [0, 1] the field is constant
    float before = 0;
    float behind = 0;
  };
  static constexpr int field_texels = 256;  ///< along the axis; OpenGL guarantees as many
  static constexpr double split_unit = 1.0 / field_texels;
  std::vector<volume::Rgba> pixels(const volume::Rect& part, const SplitField& field);

  /// Returns the fragments of `rows` rows from `first_row` on, over a field that changes linearly from one
  /// value to another as the texture coordinate `axis` goes from 0 to 1.
  struct RampField {
    std::size_t axis = 0;
    float from = 0;
    float to = 1;
  };
  std::vector<volume::Rgba> rows(int first_row, int rows, const RampField& field);

  /// Likewise, over a field that is `within` in a layer, as thin as possible, perpendicular to the texture
  /// coordinate `axis`, and `outside` elsewhere.
  struct LayerField {
    std::size_t axis = 0;
    double place = 0.5;
    float within = 1;
    float outside = 0;
  };
  std::vector<volume::Rgba> rows(int first_row, int rows, const LayerField& field);

  /// Returns the fragment of one pixel of the application's viewport, over a field of `value`.
  volume::Rgba pixel(int column, int row, float value);
  volume::Rgba pixel(int column, int row, const SplitField& field);

  /// Returns which of `pixels`, relative to the application's viewport, have a fragment if the application
  /// draws into `viewport` of the window instead, over a field of `value`.
  std::vector<bool> kept_in(const volume::Rect& pixels, const volume::Rect& viewport, float value);

  /// From now on the program reads this tile of scalars from `texture`, which is 2-D; rows bottom up, repeated.
  void show_instead(const SampledTexture& texture, int width, int height, std::span<const float> texels);
  void show_plain(const PlainTable& table);
  /// From now on the program reads from `texture`, a table of 1 or 2 dimensions, the first coordinate of its
  /// own lookup, clamped to [0, 1].
  void show_coordinate(const SampledTexture& texture);
  /// From now on the program reads its own texture again, or white if that is a gradient table.
  void show_own(const SampledTexture& texture);
  /// From now on the program reads its own gradient tables, or white ones again.
  void show_own_gradient_tables();
  void show_white_gradient_tables();

  /// The application's viewport in its window.
  int left() const { return viewport_[0]; }
  int bottom() const { return viewport_[1]; }
  int width() const { return viewport_[2]; }
  int height() const { return viewport_[3]; }
  /// The normalised device coordinates of a pixel's middle.
  double x_of(int column) const { return 2 * (column + 0.5) / width() - 1; }
  double y_of(int row) const { return 2 * (row + 0.5) / height() - 1; }
  /// The pixel at normalised device coordinates, or the nearest one in the viewport.
  int column_at(double x) const { return std::clamp(int((x + 1) / 2 * width()), 0, width() - 1); }
  int row_at(double y) const { return std::clamp(int((y + 1) / 2 * height()), 0, height() - 1); }
  /// Width and height.
  const std::array<GLint, 2>& largest_viewport() const { return largest_viewport_; }

 private:
  /// Differences of a field's texels from the field's value.
  struct Heights {
    EvenSlope slope;
    std::array<int, 3> size{};
    std::vector<float> texels;
  };
  static Heights heights_of(const EvenSlope& slope);
  void bind_in_place_of(const SampledTexture& texture);
  void give_back(const SampledTexture& texture);
  bool of_bytes(std::span<const float> texels) const;
  void show(std::span<const float> texels, const std::array<int, 3>& size, GLint filter);
  void show(const std::array<float, 8>& corners);
  void show(const SplitField& field);
  void clear();
  std::vector<volume::Rgba> in_place(int column, int row, int width, int height);
  std::vector<volume::Rgba> drawn_into(const volume::Rect& viewport, const volume::Rect& pixels);
  /// Returns `count` fragments, each over the field that `show_field` sets.
  std::vector<volume::Rgba> drawn_at(double x, double y, std::size_t count,
                                     const std::function<void(std::size_t)>& show_field);
  std::vector<volume::Rgba> drawn_at(double x, double y, std::span<const float> values, float rise);
  void learn_contrasts(std::span<const float> values);
  /// Removes the background from fragments whose samples have one of two values.
  void remove_from(std::span<volume::Rgba> fragments, float value, float other);

  const DispatchTable& gl_;
  const Run& run_;
  const TextureDescription& texture_;
  bool with_swizzle_;
  int ramp_texels_ = field_texels;   ///< the more, the closer to the box's faces a ramp extends
  std::array<GLint, 4> viewport_{};  ///< the application's
  std::array<GLint, 4> scissor_{};
  std::array<GLint, 2> largest_viewport_{};
  volume::Rect free_{};       ///< pixels of the window to which single rays are drawn
  int fine_ = 0;              ///< edge of the viewport that rays are picked from
  GLint depth_function_ = 0;  ///< the application's
  SavedState saved_;
  LiftedCuts lifted_;
  std::vector<SampledTexture> gradient_tables_;
  std::vector<GLuint> textures_;
  struct BorrowedTexture {
    GLenum target = 0;
    int unit = 0;
    bool operator==(const BorrowedTexture&) const = default;
  };
  std::vector<BorrowedTexture> borrowed_;  ///< those in whose place others are bound
  std::optional<ShaderBackground> background_;
  std::vector<CountedPlace> counted_;              ///< rays on which contrasts are measured, shortest first
  std::map<float, BackgroundContrast> contrasts_;  ///< by value
  bool complete_ = false;
};

/// Returns the textures of the tables that the program looks up by gradients, if they have 1 or 2 dimensions.
std::vector<SampledTexture> gradient_tables(const MarchContext& measured);

/// Whether `texture` is a 2-D depth texture.
bool is_depth_texture(const DispatchTable& gl, const SampledTexture& texture);

/// Whether `texture` may be what the program samples by `sampler`, a name as in program::Fetch.
bool may_be_sampled_by(const DispatchTable& gl, GLuint program, const std::string& sampler,
                       const SampledTexture& texture);

}  // namespace understudy::spu
