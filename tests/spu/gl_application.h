// SPDX-License-Identifier: Apache-2.0
// An OpenGL application inside the test: a real driver's context (EGL, no window), and above it a chain that is
// set up as by the core library. `gl()` is the table that the application calls.
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

/// start() returns null if EGL provides no such context on this machine.
class GlApplication {
 public:
  static constexpr int size = 96;  ///< width and height of the framebuffer

  static std::unique_ptr<GlApplication> start(Profile profile);
  static std::unique_ptr<GlApplication> start(Profile profile, const Options& options);
  /// A second context that shares objects with this one; becomes current on the calling thread, which must have
  /// none.
  std::unique_ptr<GlApplication> start_companion() const;
  ~GlApplication();
  GlApplication(const GlApplication&) = delete;
  GlApplication& operator=(const GlApplication&) = delete;

  /// Through the chain.
  const DispatchTable& gl() const;
  /// Bypassing the chain: the same calls without Understudy.
  const DispatchTable& driver() const;

  /// The render session that all its contexts use.
  RenderSession& session() const;

  /// False: the application calls the driver directly (bare run).
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
  /// Bytes of texels since this application started, and how many of them were skipped.
  std::uint64_t texel_bytes_sent() const;
  std::uint64_t texel_bytes_left_out() const;
  /// How often the driver's glDrawArrays was called, by the chain or the application, since this process
  /// started.
  static std::uint64_t draws_of_arrays();
  /// Counters of the last volume of this process.
  static const VolumeCounters& last_volume();

 private:
  /// The driver's context, and what is built above it.
  struct Parts;
  explicit GlApplication(std::unique_ptr<Parts> parts);
  static std::unique_ptr<GlApplication> start(Profile profile, std::shared_ptr<RenderSession> session,
                                              const GlApplication* companion);

  std::unique_ptr<Parts> parts_;
};

/// A smooth 8-bit blob with a hole, not cubic.
struct Blob {
  int x = 24, y = 20, z = 17;
  std::vector<std::uint8_t> texels() const;
};

/// PSNR of two images in dB.
double psnr(const std::vector<float>& a, const std::vector<float>& b);

}  // namespace understudy::spu::testing
