// What the application's side asks of the render nodes. A request needs nothing but the volume it names: it can
// be saved, sent, replayed and tested alone.
//
// Texture space is OpenGL's: the volume fills [0,1]^3, texel i of N is centred on (i + 1/2) / N, and the outer
// half texel belongs to the volume.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volume/classification.h"
#include "volume/fog.h"
#include "volume/image.h"
#include "volume/light.h"
#include "volume/optimizations.h"
#include "volume/surface.h"

namespace understudy::volume {

using Vec3 = std::array<double, 3>;
using Matrix4 = std::array<double, 16>;  ///< row-major: m[4 * row + column], acting on column vectors

using VolumeId = std::uint64_t;

enum class TexelType : std::uint8_t { u8, u16, f32, rgba8 };
constexpr std::size_t bytes_per_texel(TexelType type) {
  return type == TexelType::u8 ? 1 : type == TexelType::u16 ? 2 : 4;
}

/// What the linear filter reads beyond the outermost texels.
enum class Wrap : std::uint8_t { edge, border, repeat };

/// Half-open box of texels or cells.
struct TexelBox {
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  bool operator==(const TexelBox&) const = default;
};

struct VolumeDescription {
  VolumeId id = 0;
  std::uint64_t version = 0;  ///< grows whenever the texels change
  std::array<int, 3> size{};  ///< of the whole texture, in texels
  TexelType type = TexelType::u8;
  std::array<Wrap, 3> wrap{};
  Rgba border{};  ///< the texture's border colour; scalar fields use the first component
  /// The texels that travel: the part of the texture that the application shows, with one texel around it for
  /// the filter. What lies outside (power-of-two padding) is never sent and never sampled.
  TexelBox stored;
  /// So many cells around its own each node holds beside them: for the second samples of segments and segments,
  /// and for gradients (see ghost_layer_needed()).
  int ghost_layer = 0;

  bool operator==(const VolumeDescription&) const = default;
};

/// How a ray's samples become a pixel. First-hit: the first sample whose opacity is above 0 alone, opaque, in
/// its plain colour (premultiplied colour over opacity, kept within what a float holds); images of it are
/// composed by `over`, front to back.
enum class Operator : std::uint8_t { over, max, min, add, first_hit };
enum class Filter : std::uint8_t { nearest, linear };

/// What a transfer function's samples stand for. Pre-integrated: the way between two samples is a segment, on
/// which the field is taken to change evenly from one to the other; of a segment of one whole step is seen what
/// a medium would show of which an even field shows the transfer function's entries. Segments cover a ray's
/// whole way through the region (at most one step before the first sample) and are cut where clip planes and
/// opaque geometry cut the ray; a shorter segment has a power of the whole one's transparency.
///
/// Adaptive: every whole step is the longest that is taken. It is divided into 1, 2, 4, 8 or 16 equal parts, as
/// the transfer function's bends near the value in its middle ask for, and a sample is taken in the middle of
/// each, which has that power of the transfer function's transparency. Steps cover the ray as segments do, and
/// are cut as they are.
enum class Method : std::uint8_t { post_classified, pre_integrated, adaptive };

/// The application's own sample positions: planes normal . t = first + i * spacing in texture space, 0 <= i <
/// count. Plane 0 is the front: under `over`, sample i covers sample i + 1.
struct SlicePlanes {
  Vec3 normal{};
  double first = 0;
  double spacing = 0;
  int count = 0;
  bool operator==(const SlicePlanes&) const = default;
};

/// How far into its first step every ray begins, as a tile of numbers that repeats over the window: some ray
/// casters hide the rings of equal steps behind noise.
struct RayOffsets {
  int width = 0;
  int height = 0;
  std::vector<float> steps;  ///< rows bottom up

  double at(int x, int y) const {
    const auto column = std::size_t((x % width + width) % width);
    const auto row = std::size_t((y % height + height) % height);
    return double(steps[row * std::size_t(width) + column]);
  }
  bool operator==(const RayOffsets&) const = default;
};

/// The sample positions of a ray caster: constant steps along every ray, from where it enters the region. The
/// unit of length is the step: a ray that is in the region from t0 to t1 is L = |metric (t1 - t0)| steps long.
/// Sample i lies first + i steps from t0, i >= 0, up to L; where there are `offsets`, that of the pixel later.
struct RaySteps {
  /// Row-major; texture space to a space whose unit of length is the step. Or its first row alone, others zero:
  /// then steps reach from plane to plane, however slantingly a ray crosses them.
  std::array<double, 9> metric{};
  /// Whether steps reach from plane to plane.
  bool between_planes() const {
    return std::all_of(metric.begin() + 3, metric.end(), [](double v) { return v == 0; });
  }
  double first = 0;
  /// The ray is divided into n = floor(L + rounding) equal parts, n >= 1 (otherwise it has no samples); sample
  /// i lies first + i parts from t0, 0 <= i < n.
  bool divided = false;
  double rounding = 0.5;
  /// Samples up to so many steps behind the opaque geometry still count.
  double past_depth = 0;
  std::optional<RayOffsets> offsets;  ///< added to `first`, by pixel of the window
  bool operator==(const RaySteps&) const = default;
};

/// Where the second sample of a segment lies, whose first one lies on its plane: so many plane spacings further
/// along the ray (0: none), and then away by a vector. It is not bound to the region, and may be anywhere that
/// the texture's wrapping (repetition aside) gives it a value.
struct SliceSegment {
  double planes = 0;
  Vec3 offset{};
  /// The two samples are nowhere further apart than this, axis by axis in texture space.
  Vec3 reach{};
  bool operator==(const SliceSegment&) const = default;
};

struct Box {
  Vec3 low{0, 0, 0};
  Vec3 high{1, 1, 1};
  bool operator==(const Box&) const = default;
};

/// Keeps the points with normal . t + offset >= 0.
struct HalfSpace {
  Vec3 normal{};
  double offset = 0;
  bool operator==(const HalfSpace&) const = default;
};

/// Window depth in [0,1] of the opaque geometry already drawn: samples that are not nearer are hidden.
struct DepthImage {
  Rect rect;
  std::vector<float> depth;  ///< rows bottom up
  bool or_equal = false;     ///< GL_LEQUAL instead of GL_LESS
  bool operator==(const DepthImage&) const = default;
};

struct RenderRequest {
  VolumeId volume = 0;
  std::uint64_t version = 0;
  Matrix4 texture_to_clip{};  ///< clip coordinates = texture_to_clip * (t, 1)
  Rect viewport;              ///< as given to glViewport
  Rect window;                ///< the pixels that may be touched: viewport, scissor and framebuffer intersected
  std::array<double, 2> depth_range{0, 1};
  SlicePlanes planes;
  std::optional<RaySteps> steps;  ///< set: the samples lie here, not on planes
  Operator op = Operator::over;
  Filter filter = Filter::linear;
  Box region;  ///< where slices exist: samples outside this box of texture space do not; rays enter it
  std::vector<HalfSpace> clip_planes;
  Classification classification;
  std::optional<SliceSegment>
      slice_segment;       ///< set where the classification is a PreIntegrationTable, and only there
  std::optional<Fog> fog;  ///< under any operator but `min`; not with segments
  // The following are for scalar fields with a transfer function, under `over`, with a linear filter and
  // without fog; those before `light` are for samples on `steps` that end before opaque geometry.
  Method method = Method::post_classified;
  /// Pre-integrated, if not 0: segments end at the faces of bricks with so many blocks of 8^3 cells along each
  /// edge, and where the cells of a node do, as bricks that share no texel but their faces would have it
  /// (Mueller et al. 2006). It makes images depend on the partition, and is here to be compared with.
  std::uint8_t cut_at_bricks = 0;
  /// Adaptive: steps are divided until the error of each, in colour and opacity, is estimated to be no more.
  float tolerance = 1e-3F;
  /// Each is composed where the ray passes it. A sample stands for the step behind it: what of that lies in
  /// front of a surface, and what behind, has a power each of the sample's transparency.
  std::vector<Surface> surfaces;
  std::optional<Light> light;
  /// A ray stops once its transparency falls below this; the error is at most this times the brightest colour.
  float termination = 5e-6F;
  std::optional<DepthImage> depth;
  /// Nodes that send each other floats may send half floats, each time rounded to 2^-11 of a value.
  bool may_travel_as_halves = false;
  Optimizations optimizations;

  bool operator==(const RenderRequest&) const = default;
};

/// What one frame did and, beside it, what it left out. Sums over nodes.
struct FrameCounts {
  std::uint64_t rays = 0;  ///< rays that meet the region
  std::uint64_t rays_terminated = 0;
  std::uint64_t samples = 0;  ///< samples inside the region, had nothing been left out
  std::uint64_t samples_taken = 0;
  std::uint64_t samples_hidden = 0;  ///< left out behind what is opaque
  std::uint64_t dominated_samples =
      0;                     ///< left out under a maximum, in empty bricks or such that show nothing larger
  std::uint64_t blocks = 0;  ///< blocks of 8^3 cells held
  std::uint64_t blocks_empty = 0;  ///< of these, invisible under the classification
  std::uint64_t nodes_idle = 0;    ///< nodes that had nothing to show and sent nothing
  // Between nodes, for compositing: what travelled, and what would have without footprints.
  std::uint64_t bytes_exchanged = 0;
  std::uint64_t bytes_of_whole_windows = 0;
  std::uint64_t messages = 0;
  std::uint64_t messages_of_whole_windows = 0;
  double render_ms = 0;  ///< slowest node
  double composite_ms = 0;

  /// Adds another volume of the same frame: they are rendered one after the other, so times add up too.
  FrameCounts& operator+=(const FrameCounts& other) {
    rays += other.rays;
    rays_terminated += other.rays_terminated;
    samples += other.samples;
    samples_taken += other.samples_taken;
    samples_hidden += other.samples_hidden;
    dominated_samples += other.dominated_samples;
    blocks += other.blocks;
    blocks_empty += other.blocks_empty;
    nodes_idle += other.nodes_idle;
    bytes_exchanged += other.bytes_exchanged;
    bytes_of_whole_windows += other.bytes_of_whole_windows;
    messages += other.messages;
    messages_of_whole_windows += other.messages_of_whole_windows;
    render_ms += other.render_ms;
    composite_ms += other.composite_ms;
    return *this;
  }
};

}  // namespace understudy::volume
