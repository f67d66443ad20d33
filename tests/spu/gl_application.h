// SPDX-License-Identifier: Apache-2.0
// An OpenGL application inside the test: a real driver's context (EGL, no window), and a chain above it exactly
// as the body would set it up. `gl()` is what the application's calls go through.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {
struct Options;
struct VolumeCounters;
class RenderSession;
}  // namespace understudy::spu

namespace understudy::spu::testing {

enum class Profile { compatibility, core };

/// Null when this machine has no EGL that gives such a context.
class GlApplication {
 public:
  static constexpr int size = 96;  ///< of the framebuffer, both ways

  static std::unique_ptr<GlApplication> start(Profile profile);
  static std::unique_ptr<GlApplication> start(Profile profile, const Options& options);
  /// A second context that shares its objects, current on the calling thread, where no other may be.
  std::unique_ptr<GlApplication> start_companion() const;
  ~GlApplication();
  GlApplication(const GlApplication&) = delete;
  GlApplication& operator=(const GlApplication&) = delete;

  /// Through the chain.
  const DispatchTable& gl() const;
  /// Past the chain: what the same calls do without Understudy.
  const DispatchTable& driver() const;

  /// What all its contexts speak to the render service through.
  RenderSession& session() const;

  /// With false the application talks to the driver: the bare run.
  void use_chain(bool on);

  /// As the entry library does around glXSwapBuffers.
  void end_frame();

  std::vector<float> read_pixels();
  std::vector<float> read_depth();
  GLenum error() { return driver().GetError(); }

  /// Runs of slices since this application started.
  std::uint64_t substituted() const;
  std::uint64_t left() const;
  std::string last_reason() const;
  /// Bytes of texels since this application started, and what was left out of them.
  std::uint64_t texel_bytes_sent() const;
  std::uint64_t texel_bytes_left_out() const;
  /// How often the driver was asked for glDrawArrays, by the chain or the application, since this process
  /// started.
  static std::uint64_t draws_of_arrays();
  /// The figures of the last volume that this process has seen.
  static const VolumeCounters& last_volume();

 private:
  /// Its context of the driver, and what stands above.
  struct Parts;
  explicit GlApplication(std::unique_ptr<Parts> parts);
  static std::unique_ptr<GlApplication> start(Profile profile, std::shared_ptr<RenderSession> session,
                                              const GlApplication* companion);

  std::unique_ptr<Parts> parts_;
};

/// A smooth blob with a hole, 8 bits, non-cubic.
struct Blob {
  int x = 24, y = 20, z = 17;
  std::vector<std::uint8_t> texels() const;
};

/// PSNR of two images in dB.
double psnr(const std::vector<float>& a, const std::vector<float>& b);

}  // namespace understudy::spu::testing
