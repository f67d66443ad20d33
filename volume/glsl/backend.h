// SPDX-License-Identifier: Apache-2.0
// Selects what casts a node's rays: the CPU, OpenGL, or whichever is measured to be faster.
//
// Inside an application's process only the CPU is used: OpenGL's names are bound to the entry library there,
// and the calling thread has the application's context current.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "volume/glsl/texture_memory.h"
#include "volume/raycast/brick_renderer.h"

namespace understudy::volume::glsl {

/// gl: EGL, or OSMesa if EGL is unavailable. automatic: measured on the first images of each kind.
enum class Backend { cpu, gl, egl, osmesa, automatic };

constexpr const char* backend_names = "cpu, gl, gl:egl, gl:osmesa, auto";
std::optional<Backend> backend_of(std::string_view name);

/// Creates renderers that draw with the requested backend, and on the CPU where OpenGL cannot. Every choice is
/// reported once, in a line with the reason.
class BackendChooser {
 public:
  using Tell = std::function<void(const std::string&)>;

  BackendChooser(Backend wish, Tell tell, const TextureMemoryWish& memory = {});
  ~BackendChooser();
  BackendChooser(const BackendChooser&) = delete;
  BackendChooser& operator=(const BackendChooser&) = delete;

  /// The chooser must outlive the factory and its renderers. All of them belong to one thread at a time.
  BrickRendererFactory factory();

 private:
  struct Shared;
  class Renderer;

  std::unique_ptr<Shared> shared_;
};

}  // namespace understudy::volume::glsl
