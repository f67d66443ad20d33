// SPDX-License-Identifier: Apache-2.0
// Draws slices through volumes in double precision, by the OpenGL specification and without any code of
// Understudy: trilinear samples clamped to the edge, a transfer function, a blend function, and opaque
// triangles that hide by depth.
//
// Beside the exact image it computes bounds: `Precision` specifies how exactly the tested renderer samples,
// `Rounding` how exactly it blends, and the interval of every channel follows from the two. No test needs a
// bound that was read off a result.
#pragma once

#include <array>
#include <vector>

#include "tests/emulation/bounded.h"

namespace emulation {

using Vec3 = std::array<double, 3>;
using Colour = std::array<double, 4>;
using Matrix = std::array<double, 16>;  ///< column-major, as OpenGL has it

Matrix product(const Matrix& a, const Matrix& b);
/// Transforms and divides by w.
Vec3 project(const Matrix& m, const Vec3& p);

struct Field {
  std::array<int, 3> size{};
  int components = 1;          ///< or 4: RGBA
  std::vector<double> texels;  ///< x fastest
};

struct Table {
  std::vector<Colour> entries;
  /// Position of a value among the entries: scale * value + offset; linear between entries, constant outside.
  double scale = 255;
  double offset = 0;
  /// The entries are bytes, and the driver's filter returns bytes.
  bool bytes = false;
};

/// The transfer function's channel at `value`.
double entry_at(const Table& table, double value, std::size_t channel);

struct Volume {
  Field field;
  Table table;                ///< for a field with one component
  Colour factor{1, 1, 1, 1};  ///< multiplies every fragment
  Matrix clip_from_texture{};
  Vec3 normal{};                ///< dot(normal, t) = offset, in texture space
  std::vector<double> offsets;  ///< in drawing order
};

struct Triangle {
  std::array<Vec3, 3> clip;  ///< normalised device coordinates
  std::array<double, 3> colour{};
};

enum class Factor {
  zero,
  one,
  source_alpha,
  one_minus_source_alpha,
  destination_alpha,
  one_minus_destination_alpha
};
enum class Equation { add, max, min };
struct BlendFunction {
  Equation equation = Equation::add;
  Factor source = Factor::one;
  Factor destination = Factor::one;
};
struct Blending {
  BlendFunction colour;
  BlendFunction alpha;
};

struct Frame {
  int width = 0;
  int height = 0;
  Colour background{};
  std::vector<Volume> volumes;  ///< in drawing order
  Blending blending;
  std::vector<Triangle> solid;  ///< hides slices that are not nearer
  /// The slices are drawn onto transparent black; opaque triangles and background are blended under them
  /// afterwards.
  bool background_last = false;
};

/// Errors of sampling.
struct Precision {
  double coordinate = 0;  ///< of texture coordinates
  double window = 0;      ///< pixels: displacement of slices' vertices, samples and edges
  double texel = 0;       ///< texels: error of the filter's weights
  double value = 0;       ///< of the filtered value
  double solid = 0;       ///< pixels: displacement of the vertices of opaque triangles
  double depth = 0;       ///< of window depth
  /// Colours are read from a measured transfer function with this many cells over [0,1]; 0: they are not.
  double table_cells = 0;
};

/// Errors of a framebuffer's format and of blending into it: absolute, for values in [0,1].
struct Rounding {
  double source = 0;  ///< of a fragment's channels before blending
  double result = 0;  ///< of the stored value
  double alpha_source = 0;
  double alpha_result = 0;
  double relative = 0;  ///< relative error of the stored value
  bool clamps = true;   ///< normalised formats
};

struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::array<Bounded, 4>> pixels;  ///< top row first
};

/// Blends every slice with `each_slice`, and stores the result of each volume's slices once more with
/// `each_volume`: the former is how the viewer draws, the latter how Understudy does.
Image draw(const Frame& frame, const Precision& precision, const Rounding& each_slice,
           const Rounding& each_volume);

/// Composites the slices of one volume onto an empty image: premultiplied colour and opacity for over and
/// under, or sums, maxima or minima. Pixels without a sample are 0, or `no_sample` for a minimum.
constexpr double no_sample = 3.4028234663852886e38;
Image draw_alone(const Frame& frame, const Volume& volume, const Precision& precision);

/// The first `channels` channels of each pixel, in exact arithmetic.
std::vector<double> meant(const Image& image, int channels);

/// How an image compares with its bounds, over the first `channels` channels of each pixel.
struct Verdict {
  double rms = 0;     ///< error against the exact image
  double max = 0;     ///< error against the exact image
  double beyond = 0;  ///< greatest distance outside the bounds; 0: none
  double width = 0;   ///< RMS distance of the bounds from the exact image: what could go unnoticed
  int outside = 0;    ///< channels outside their bounds by more than `slack`
};
Verdict judge(const Image& image, const std::vector<double>& drawn, int channels, double slack = 0);

}  // namespace emulation
