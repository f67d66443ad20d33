// SPDX-License-Identifier: Apache-2.0
// understudy-bench-raycast: measures ray casting alone, without window, OpenGL or network. One image is
// rendered repeatedly. Reports the processor time per sample of the image, whether the sample was taken or
// skipped, and the error. Prints one JSON object.
#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "volume/brick/brick_store.h"
#include "volume/cell_lattice.h"
#include "volume/frame_counts.h"
#include "volume/glsl/glsl_ray_caster.h"
#include "volume/image.h"
#include "volume/matrix.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/segment_scene.h"
#include "volume/reference/pixel_integral.h"
#include "volume/reference/segment_sum.h"
#include "volume/request.h"

namespace {

using namespace understudy::volume;

struct Settings {
  std::string file;
  std::array<int, 3> size{256, 256, 256};
  std::string table = "dense";
  TexelType type = TexelType::u8;
  int pixels = 512;
  int threads = 1;
  int frames = 9;
  float epsilon = 1e-5F;
  Method method = Method::post_classified;
  std::vector<double> surfaces;
  bool light = false;
  std::string backend = "cpu";
  std::string judged;  ///< image of another renderer, as floats, to be judged; empty: ours is judged
  int stride = 8;      ///< the error is measured at every stride-th pixel along each axis
  bool unjudged = false;
  int magnify = 1;
  std::optional<std::uint64_t> noise;  ///< seed of noise that replaces the file
  glsl::TextureMemoryWish gpu_memory;
};

/// Uncorrelated bytes: the worst case for caches.
std::vector<std::byte> noise(std::size_t count, std::uint64_t seed) {
  std::vector<std::byte> bytes((count + 7) / 8 * 8);
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    // splitmix64 (Steele, Lea, Flood 2014)
    std::uint64_t hash = seed + 0x9E3779B97F4A7C15U * (i / 8 + 1);
    hash = (hash ^ hash >> 30U) * 0xBF58476D1CE4E5B9U;
    hash = (hash ^ hash >> 27U) * 0x94D049BB133111EBU;
    hash ^= hash >> 31U;
    std::memcpy(&bytes[i], &hash, sizeof hash);
  }
  bytes.resize(count);
  return bytes;
}

/// Returns the file's voxels, each repeated settings.magnify times along every axis.
std::vector<std::byte> texels_of(const Settings& settings) {
  if (settings.noise)
    return noise(std::size_t(settings.size[0]) * std::size_t(settings.size[1]) * std::size_t(settings.size[2]),
                 *settings.noise);
  std::ifstream in(settings.file, std::ios::binary);
  const auto factor = std::size_t(settings.magnify);
  const std::array<std::size_t, 3> size{std::size_t(settings.size[0]), std::size_t(settings.size[1]),
                                        std::size_t(settings.size[2])},
      in_file{size[0] / factor, size[1] / factor, size[2] / factor};
  const std::size_t count = size[0] * size[1] * size[2];
  std::vector<std::byte> bytes(in_file[0] * in_file[1] * in_file[2]);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size())))
    throw std::runtime_error(fmt::format("{} does not contain {} bytes", settings.file, bytes.size()));
  if (factor > 1) {
    std::vector<std::byte> large(count);
    for (std::size_t z = 0; z < size[2]; ++z)
      for (std::size_t y = 0; y < size[1]; ++y) {
        const std::byte* const from = &bytes[(z / factor * in_file[1] + y / factor) * in_file[0]];
        std::byte* const to = &large[(z * size[1] + y) * size[0]];
        for (std::size_t x = 0; x < size[0]; ++x) to[x] = from[x / factor];
      }
    bytes = std::move(large);
  }
  if (settings.type == TexelType::u8) return bytes;
  // The same values in 16 bits.
  std::vector<std::byte> wide(2 * count);
  for (std::size_t i = 0; i < count; ++i) wide[2 * i] = wide[2 * i + 1] = bytes[i];
  return wide;
}

/// Dense: every value is slightly opaque. Sparse: only the higher values are, and they soon hide the rest.
/// Clear: no value is, for surfaces alone.
TransferFunction transfer_function(const std::string& name) {
  constexpr int first_visible = 140;
  TransferFunction function;
  for (int i = 0; i < 256; ++i) {
    const double dense = 0.002 + 0.03 * i / 255;
    const double sparse = i < first_visible ? 0 : std::min(1.0, 0.02 + 0.3 * (i - first_visible) / 60.0);
    const double alpha = name == "clear" ? 0 : name == "sparse" ? sparse : dense;
    function.entries.push_back({float(alpha * (0.3 + 0.7 * i / 255)),
                                float(alpha * (0.5 + 0.5 * std::sin(i * 0.05))),
                                float(alpha * (1 - 0.8 * i / 255)), float(alpha)});
  }
  return function;
}

/// The eye is two edges away, at azimuth 30 and elevation 25 degrees; field of view 40
/// degrees, one sample a voxel.
RenderRequest request(const Settings& settings) {
  constexpr double degree = std::numbers::pi / 180;
  const double side = *std::max_element(settings.size.begin(), settings.size.end());
  const Vec3 back{std::sin(30 * degree) * std::cos(25 * degree), std::sin(25 * degree),
                  std::cos(30 * degree) * std::cos(25 * degree)};
  const Vec3 right{std::cos(30 * degree), 0, -std::sin(30 * degree)};
  const Vec3 up = cross(back, right);
  const double near = 0.5 * side, far = 4 * side, f = 1 / std::tan(20 * degree);
  const Matrix4 projection{
      f, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), 2 * far * near / (near - far), 0, 0, -1, 0};
  const Matrix4 view{right[0], right[1], right[2], 0,         up[0], up[1], up[2], 0,
                     back[0],  back[1],  back[2],  -2 * side, 0,     0,     0,     1};
  const Matrix4 voxels{double(settings.size[0]),
                       0,
                       0,
                       -0.5 * settings.size[0],
                       0,
                       double(settings.size[1]),
                       0,
                       -0.5 * settings.size[1],
                       0,
                       0,
                       double(settings.size[2]),
                       -0.5 * settings.size[2],
                       0,
                       0,
                       0,
                       1};
  RenderRequest r;
  r.volume = 1;
  r.version = 1;
  r.texture_to_clip = multiply(projection, multiply(view, voxels));
  r.viewport = r.window = {0, 0, settings.pixels, settings.pixels};
  r.steps.emplace();
  r.steps->metric = {double(settings.size[0]), 0, 0, 0, double(settings.size[1]), 0, 0, 0,
                     double(settings.size[2])};
  r.classification = transfer_function(settings.table);
  r.termination = settings.epsilon;
  r.method = settings.method;
  for (std::size_t i = 0; i < settings.surfaces.size(); ++i)
    r.surfaces.push_back(
        {settings.surfaces[i], {1, 0.8F, 0.6F, i + 1 == settings.surfaces.size() ? 1.0F : 0.4F}});
  if (settings.light) {
    r.light.emplace();
    r.light->direction = {1, 2, 1.5};
    // A quarter of a byte per voxel.
    r.light->full_slope = float(settings.size[0]) / 1024;
  }
  return r;
}

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Errors {
  double largest = 0;
  double squares = 0;
  std::size_t count = 0;

  void add(const float* ours, const double* exact) {
    for (int k = 0; k < 4; ++k) {
      const double d = std::abs(double(ours[k]) - exact[k]);
      largest = std::max(largest, d);
      squares += d * d;
      ++count;
    }
  }
  double rms() const { return std::sqrt(squares / double(count)); }
};

VolumeDescription description_of(const Settings& settings, const RenderRequest& asked) {
  VolumeDescription volume;
  volume.id = 1;
  volume.version = 1;
  volume.size = settings.size;
  volume.type = settings.type;
  volume.stored = {{0, 0, 0}, settings.size};
  volume.ghost_layer = ghost_layer_needed(volume, asked);
  return volume;
}

/// Adds to `figures` the errors of the image against the sum of the same samples, and against the integral.
void judge(const Settings& settings, const VolumeDescription& volume, std::span<const std::byte> texels,
           const RenderRequest& asked, const Image& image, nlohmann::ordered_json& figures) {
  const Field field = texture_field(volume, Filter::linear, texels);
  const Medium medium = Medium::of_samples(std::get<TransferFunction>(asked.classification), 1);
  Errors arithmetic, total;
  double reference_seconds = 0;
  std::size_t rays = 0;
  for (int y = settings.stride / 2; y < settings.pixels; y += settings.stride) {
    for (int x = settings.stride / 2; x < settings.pixels; x += settings.stride) {
      const Rect pixel{x, y, 1, 1};
      const float* ours = &image.rgba[4 * (std::size_t(y) * std::size_t(settings.pixels) + std::size_t(x))];
      if (settings.method != Method::adaptive) {
        const ReferenceImage same =
            walks_segments(asked) ? segment_sum(field, volume, asked, pixel) : slice_sum(field, asked, pixel);
        arithmetic.add(ours, same.at(x, y));
      }
      if (!settings.surfaces.empty() || settings.light) continue;  // the integral supports neither
      const double before = processor_seconds();
      total.add(ours, pixel_integral(field, settings.size, asked, medium, x, y).data());
      reference_seconds += processor_seconds() - before;
      ++rays;
    }
  }
  // Adaptive steps are defined by the kernel itself, so they can only be compared with the integral.
  if (settings.method != Method::adaptive) {
    figures["max_arithmetic"] = arithmetic.largest;
    figures["rms_arithmetic"] = arithmetic.rms();
  }
  if (rays > 0) {
    figures["max_total"] = total.largest;
    figures["rms_total"] = total.rms();
    figures["reference_rays_per_second"] = double(rays) / reference_seconds;
  }
}

nlohmann::ordered_json measure(const Settings& settings) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(settings.threads));
  std::vector<std::byte> texels = texels_of(settings);
  const RenderRequest asked = request(settings);
  const VolumeDescription volume = description_of(settings, asked);
  BrickStore store(volume, cell_lattice(volume).box());
  store.add_slices(volume.stored, texels);
  store.finish();
  if (settings.unjudged) texels = {};
  // Mesa reads its number of threads when the context is created.
  setenv("LP_NUM_THREADS", fmt::format("{}", settings.threads).c_str(), 0);
  std::optional<glsl::Device> device;
  if (settings.backend != "cpu")
    device.emplace(settings.backend == "gl" ? glsl::Platform::egl : glsl::Platform::osmesa,
                   settings.gpu_memory);
  const std::unique_ptr<BrickRenderer> caster =
      device ? std::unique_ptr<BrickRenderer>(std::make_unique<glsl::GlslRayCaster>(store, *device))
             : cpu_renderer(store);
  Image image(asked.viewport);
  FrameCounts counts;
  caster->render(asked, image, counts);  // makes once what depends on the transfer function alone
  std::vector<double> wall, processor;
  for (int frame = 0; frame < settings.frames; ++frame) {
    const auto start = std::chrono::steady_clock::now();
    const double before = processor_seconds();
    FrameCounts same;
    caster->render(asked, image, same);
    processor.push_back(processor_seconds() - before);
    wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }

  if (!settings.judged.empty()) {
    std::ifstream in(settings.judged, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(image.rgba.data()),
                 std::streamsize(sizeof(float) * image.rgba.size())))
      throw std::runtime_error(
          fmt::format("{} does not contain {} floats", settings.judged, image.rgba.size()));
  }
  const double samples = double(counts.samples);
  nlohmann::ordered_json figures{{"ns", 1e9 * median(processor) / samples},
                                 {"wall_ms", 1e3 * median(wall)},
                                 {"samples", counts.samples},
                                 {"samples_taken", counts.samples_taken},
                                 {"threads", settings.threads},
                                 {"epsilon", settings.epsilon},
                                 {"instruction_set", instruction_set()},
                                 {"renderer", device ? device->description() : "CPU"}};
  if (!settings.unjudged) judge(settings, volume, texels, asked, image, figures);
  return figures;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Times ray casting of one volume of bytes, and measures its error."};
  app.set_help_flag("-h,--help", "print this help and exit");
  CLI::Option* file =
      app.add_option("volume", settings.file, "volume file: raw bytes, x fastest")->check(CLI::ExistingFile);
  app.add_option("--noise", settings.noise, "use the bytes of a hash with this seed, instead of a file")
      ->excludes(file);
  app.add_option("--size", settings.size, "number of voxels along x, y and z")->delimiter('x');
  app.add_option("--magnify", settings.magnify, "magnify the file's volume by this factor along every axis")
      ->check(CLI::Range(1, 16));
  app.add_flag("--unjudged", settings.unjudged, "measure times only");
  app.add_option("--table", settings.table, "transfer function")
      ->check(CLI::IsMember({"dense", "sparse", "clear"}));
  app.add_option("--method", settings.method, "classification of samples")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, Method>{{"post-classified", Method::post_classified},
                                                                {"pre-integrated", Method::pre_integrated},
                                                                {"adaptive", Method::adaptive}}));
  app.add_option("--surfaces", settings.surfaces, "values of iso-surfaces, of which the last one is opaque")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--light", settings.light, "light samples and surfaces");
  app.add_option("--type", settings.type, "type of the voxels that the bytes are converted to")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, TexelType>{{"u8", TexelType::u8}, {"u16", TexelType::u16}}));
  app.add_option("--pixels", settings.pixels, "edge of the image, in pixels")->check(CLI::Range(1, 16384));
  app.add_option("--threads", settings.threads, "maximum number of threads")->check(CLI::Range(1, 1024));
  app.add_option("--frames", settings.frames, "number of images, of whose times the median counts")
      ->check(CLI::Range(1, 10000));
  app.add_option("--backend", settings.backend,
                 "backend that casts the rays: cpu, or OpenGL on EGL (gl) or on OSMesa (gl-osmesa)")
      ->check(CLI::IsMember({"cpu", "gl", "gl-osmesa"}));
  app.add_option("--gpu-memory", settings.gpu_memory.bytes, "graphics memory for texels, in bytes");
  app.add_option("--judge", settings.judged,
                 "measure the errors of another renderer's image in this file, of premultiplied RGBA floats "
                 "with rows from bottom to top")
      ->check(CLI::ExistingFile);
  app.add_option("--epsilon", settings.epsilon,
                 "early ray termination: a ray ends where its remaining transparency is below this value")
      ->check(CLI::Range(0.0, 1.0));
  CLI11_PARSE(app, argc, argv);
  if (settings.file.empty() && !settings.noise) {
    fmt::print(stderr, "understudy-bench-raycast: give a file of voxels, or --noise SEED\n");
    return 1;
  }
  try {
    fmt::print("{}\n", measure(settings).dump());
  } catch (const std::exception& error) {
    fmt::print(stderr, "understudy-bench-raycast: {}\n", error.what());
    return 1;
  }
}
