// SPDX-License-Identifier: Apache-2.0
// Slices through volumes, drawn once more in double precision, by the words of the OpenGL specification and
// without anything of ours: trilinear samples clamped to the edge, a table, a blend function, solid triangles
// that hide by their depth.
//
// Beside the image that is meant, its bounds: `Precision` says how exactly the one who is judged takes its
// samples, `Rounding` how it blends, and the interval of every channel follows from them. No bound of a test
// needs a number that was read off a result.
#pragma once

#include <array>
#include <vector>

#include "tests/emulation/bounded.h"

namespace emulation {

using Vec3 = std::array<double, 3>;
using Colour = std::array<double, 4>;
using Matrix = std::array<double, 16>;  ///< column-major, as OpenGL has it

Matrix product(const Matrix& a, const Matrix& b);
/// With the division by w.
Vec3 project(const Matrix& m, const Vec3& p);

struct Field {
  std::array<int, 3> size{};
  int components = 1;          ///< or 4: RGBA
  std::vector<double> texels;  ///< x fastest
};

struct Table {
  std::vector<Colour> entries;
  /// A value's place among the entries: scale * value + offset, linear between entries, constant outside.
  double scale = 255;
  double offset = 0;
  /// The entries are bytes, and the driver's filter answers in bytes.
  bool bytes = false;
};

/// The table's channel at `value`.
double entry_at(const Table& table, double value, std::size_t channel);

struct Volume {
  Field field;
  Table table;                ///< of a field with one component
  Colour factor{1, 1, 1, 1};  ///< every fragment is multiplied by it
  Matrix clip_from_texture{};
  Vec3 normal{};                ///< dot(normal, t) = offset, in texture space
  std::vector<double> offsets;  ///< in the order of drawing
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
  std::vector<Volume> volumes;  ///< in the order of drawing
  Blending blending;
  std::vector<Triangle> solid;  ///< hides what is not nearer
  /// The slices fall onto transparent black, and what is solid and the background come after them.
  bool background_last = false;
};

/// How exactly samples are taken.
struct Precision {
  double coordinate = 0;  ///< of texture coordinates
  double window = 0;      ///< pixels: where slices' vertices, samples and edges may be displaced to
  double texel = 0;       ///< texels: of the filter's weights
  double value = 0;       ///< of what the filter gives
  double solid = 0;       ///< pixels: where vertices of solid triangles may be displaced to
  double depth = 0;       ///< of window depth
  /// Colours are read from a table of so many cells over [0,1] that was measured first; 0: they are not.
  double table_cells = 0;
};

/// What a framebuffer's format, and the blending into it, may change: absolute, of values in [0,1].
struct Rounding {
  double source = 0;  ///< of a fragment's channels before they are blended
  double result = 0;  ///< of what is stored
  double alpha_source = 0;
  double alpha_result = 0;
  double relative = 0;  ///< of what is stored, too
  bool clamps = true;   ///< normalised formats
};

struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::array<Bounded, 4>> pixels;  ///< rows top down
};

/// Every slice is blended with `each_slice`; what came of all slices of one volume is stored once more with
/// `each_volume`: the two are the viewer's own way and ours.
Image draw(const Frame& frame, const Precision& precision, const Rounding& each_slice,
           const Rounding& each_volume);

/// What the slices of one volume make of nothing: colour and coverage of over and under, premultiplied; sums;
/// the greatest or the least values. Pixels without a sample are 0, or `no_sample` under a minimum.
constexpr double no_sample = 3.4028234663852886e38;
Image draw_alone(const Frame& frame, const Volume& volume, const Precision& precision);

/// So many channels of each pixel, in exact arithmetic.
std::vector<double> meant(const Image& image, int channels);

/// How an image lies to its bounds; channels in the order of Image, so many of each pixel as `channels`.
struct Verdict {
  double rms = 0;     ///< to what is meant
  double max = 0;     ///< to what is meant
  double beyond = 0;  ///< the farthest outside of the bounds; 0: none
  double width = 0;   ///< RMS of the bounds' distance to what is meant: what could go unnoticed
  int outside = 0;    ///< channels beyond their bounds by more than `slack`
};
Verdict judge(const Image& image, const std::vector<double>& drawn, int channels, double slack = 0);

}  // namespace emulation
