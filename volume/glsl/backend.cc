// SPDX-License-Identifier: Apache-2.0
#include "volume/glsl/backend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <compare>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include "volume/brick/brick_store.h"
#include "volume/frame_counts.h"
#include "volume/glsl/glsl_ray_caster.h"
#include "volume/image.h"
#include "volume/occlusion.h"
#include "volume/request.h"

namespace understudy::volume::glsl {

namespace {

/// Images of a kind that each backend draws before the choice; the first one includes one-time costs.
constexpr int images_measured = 2;
/// Images with fewer samples are not representative of speed.
constexpr std::uint64_t least_samples = 50000;

constexpr std::array<std::pair<std::string_view, Backend>, 5> names{{{"cpu", Backend::cpu},
                                                                     {"gl", Backend::gl},
                                                                     {"gl:egl", Backend::egl},
                                                                     {"gl:osmesa", Backend::osmesa},
                                                                     {"auto", Backend::automatic}}};

/// The properties of a request that determine which backend is faster.
struct Kind {
  TexelType type{};
  Operator op{};
  Filter filter{};
  bool mostly_empty = false;

  auto operator<=>(const Kind&) const = default;  // NOLINT(modernize-use-nullptr): there is no pointer
};

std::string text_of(const Kind& kind) {
  constexpr std::array types{"u8", "u16", "f32", "rgba8"};
  constexpr std::array operators{"over", "max", "min", "add", "first hit"};
  constexpr std::array filters{"nearest", "linear", "8-bit linear"};
  return fmt::format("{}, {}, {} filter, {}", types.at(std::size_t(kind.type)),
                     operators.at(std::size_t(kind.op)), filters.at(std::size_t(kind.filter)),
                     kind.mostly_empty ? "most blocks empty" : "most blocks visible");
}

/// Nanoseconds per sample inside the volume, of the fastest image of each backend.
struct Speeds {
  int cpu_images = 0, gl_images = 0;
  double cpu = std::numeric_limits<double>::infinity(), gl = cpu;
  std::optional<bool> gl_is_faster;
};

}  // namespace

std::optional<Backend> backend_of(std::string_view name) {
  const auto* const found =
      std::find_if(names.begin(), names.end(), [&](const auto& entry) { return entry.first == name; });
  return found == names.end() ? std::nullopt : std::optional(found->second);
}

struct BackendChooser::Shared {
  Backend wish;
  Tell tell;
  TextureMemoryWish memory;
  std::unique_ptr<Device> device;
  bool device_tried = false;
  std::map<Kind, Speeds> speeds;  ///< of this node
  std::set<std::string> told;

  void tell_once(const std::string& line) {
    if (told.insert(line).second) tell(line);
  }

  bool has_no_device() const { return device_tried && !device; }

  /// Null if OpenGL is unavailable; the reason has been reported then.
  Device* open_device() {
    if (std::exchange(device_tried, true)) return device.get();
    std::string reasons;
    const auto attempt = [&](Platform platform) {
      if (device) return;
      try {
        device = std::make_unique<Device>(platform, memory);
      } catch (const std::runtime_error& absent) {
        reasons += (reasons.empty() ? "" : "; ") + std::string(absent.what());
      }
    };
    if (wish != Backend::osmesa) attempt(Platform::egl);
    if (wish != Backend::egl) attempt(Platform::osmesa);
    if (!device) tell_once("CPU: " + reasons);
    return device.get();
  }
};

class BackendChooser::Renderer final : public BrickRenderer {
 public:
  Renderer(Shared& shared, const BrickStore& store)
      : shared_(shared), store_(store), cpu_(cpu_renderer(store)) {}

  void blocks_changed(std::span<const std::size_t> blocks) override {
    cpu_->blocks_changed(blocks);
    if (gl_) gl_->blocks_changed(blocks);
  }
  // OpenGL takes longer for the same samples, but relative costs are about the same.
  void estimate_costs(const RenderRequest& request, std::span<const Rect> tiles,
                      std::span<float> costs) override {
    cpu_->estimate_costs(request, tiles, costs);
  }

 private:
  void draw(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) override {
    FrameCounts mine;
    if (!draw_with_opengl(request, out, mine, occlusion)) draw_on_cpu(request, out, mine, occlusion);
    mostly_empty_ = 2 * mine.blocks_empty > mine.blocks;
    few_samples_ = mine.samples < least_samples;
    counts += mine;
  }

  Kind kind_of(const RenderRequest& request) const {
    return {store_.description().type, request.op, request.filter, mostly_empty_};
  }

  bool draw_with_opengl(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) {
    if (shared_.wish == Backend::cpu || failed_ || store_.empty()) return false;
    if (shared_.wish == Backend::automatic && !wanted(kind_of(request))) return false;
    Device* device = shared_.open_device();
    if (device == nullptr) return false;
    if (lacks_memory()) return false;
    if (!gl_) gl_ = std::make_unique<GlslRayCaster>(store_, *device);
    if (const auto reason = gl_->obstacle(request)) {
      shared_.tell_once(fmt::format("CPU: the GL backend does not draw {}", *reason));
      return false;
    }
    try {
      measured(request, counts, &Speeds::gl, &Speeds::gl_images,
               [&] { gl_->render(request, out, counts, occlusion); });
    } catch (const NoTextureMemory& error) {
      // Other volumes use the memory: retried once more of it is left.
      too_little_ = device->texture_memory().left();
      gl_.reset();
      shared_.tell_once(fmt::format("CPU for volume {}: {}", store_.description().id, error.what()));
      return false;
    } catch (const std::runtime_error& error) {
      failed_ = true;
      gl_.reset();
      shared_.tell_once(fmt::format("CPU for volume {}: {}", store_.description().id, error.what()));
      return false;
    }
    if (shared_.wish != Backend::automatic)
      shared_.tell_once(fmt::format("GL, as asked: {}", device->description()));
    if (const BrickFigures figures = gl_->brick_figures(); figures.bricks > 0)
      shared_.tell_once(
          fmt::format("GL draws volume {} by bricks, of which {} of {} are in its memory at a time",
                      store_.description().id, figures.slots, figures.bricks));
    return true;
  }

  void draw_on_cpu(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) {
    if (!compares(request)) return cpu_->render(request, out, counts, occlusion);
    // Hidden samples cost no time, and would distort the time per sample.
    measured(request, counts, &Speeds::cpu, &Speeds::cpu_images,
             [&] { cpu_->render(request, out, counts, nullptr); });
  }

  /// Whether an image on the CPU serves the comparison of its kind with OpenGL.
  bool compares(const RenderRequest& request) const {
    if (shared_.wish != Backend::automatic || few_samples_ || !may_draw_with_opengl(request)) return false;
    const auto found = shared_.speeds.find(kind_of(request));
    return found == shared_.speeds.end() || !found->second.gl_is_faster;
  }

  /// Whether OpenGL could draw the image, as far as is known: no device is opened to find out.
  bool may_draw_with_opengl(const RenderRequest& request) const {
    if (failed_ || store_.empty() || shared_.has_no_device()) return false;
    if (gl_) return !gl_->obstacle(request);
    return !lacks_memory();
  }

  /// Whether the volume did not fit into the device's memory, of which no more is left since.
  bool lacks_memory() const {
    return !gl_ && too_little_ && shared_.device->texture_memory().left() <= *too_little_;
  }

  /// Whether OpenGL draws the next image of this kind: while measuring, after the CPU's images; then always if
  /// it was faster.
  bool wanted(const Kind& kind) const {
    const auto found = shared_.speeds.find(kind);
    if (found == shared_.speeds.end()) return false;
    const Speeds& speeds = found->second;
    return speeds.gl_is_faster.value_or(speeds.cpu_images >= images_measured);
  }

  template <class Draw>
  void measured(const RenderRequest& request, const FrameCounts& counts, double Speeds::*speed,
                int Speeds::*images, Draw draw) {
    const auto start = std::chrono::steady_clock::now();
    draw();
    const double ns =
        std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
    if (shared_.wish != Backend::automatic || counts.samples < least_samples) return;
    const Kind kind = kind_of(request);
    Speeds& speeds = shared_.speeds[kind];
    if (speeds.gl_is_faster) return;
    speeds.*speed = std::min(speeds.*speed, ns / double(counts.samples));
    ++(speeds.*images);
    if (speeds.cpu_images < images_measured || speeds.gl_images < images_measured) return;
    speeds.gl_is_faster = speeds.gl < speeds.cpu;
    shared_.tell_once(fmt::format("{} for {}: GL takes {:.2f} ns a sample, the CPU {:.2f} ({})",
                                  *speeds.gl_is_faster ? "GL" : "CPU", text_of(kind), speeds.gl, speeds.cpu,
                                  shared_.device->description()));
  }

  Shared& shared_;
  const BrickStore& store_;
  std::unique_ptr<BrickRenderer> cpu_;
  std::unique_ptr<GlslRayCaster> gl_;
  bool failed_ = false;                      ///< OpenGL failed on this volume
  std::optional<std::uint64_t> too_little_;  ///< texture memory that was left when this volume did not fit
  bool mostly_empty_ = false;                ///< as of the last image
  bool few_samples_ = false;                 ///< likewise: too few to measure
};

BackendChooser::BackendChooser(Backend wish, Tell tell, const TextureMemoryWish& memory)
    : shared_(std::make_unique<Shared>(Shared{wish, std::move(tell), memory, nullptr, false, {}, {}})) {}
BackendChooser::~BackendChooser() = default;

BrickRendererFactory BackendChooser::factory() {
  return [this](const BrickStore& store) -> std::unique_ptr<BrickRenderer> {
    return std::make_unique<Renderer>(*shared_, store);
  };
}

}  // namespace understudy::volume::glsl
