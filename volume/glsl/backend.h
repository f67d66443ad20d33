// SPDX-License-Identifier: Apache-2.0
// Who casts a node's rays: the CPU, OpenGL, or whichever turns out to be faster here.
//
// For an application's own process there is the CPU alone: OpenGL's names mean its entry library there, and its
// thread has the application's context current.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "volume/glsl/texture_memory.h"
#include "volume/raycast/brick_renderer.h"

namespace understudy::volume::glsl {

/// gl: EGL, or OSMesa where there is no EGL. automatic: measured on the first images of each kind.
enum class Backend { cpu, gl, egl, osmesa, automatic };

constexpr const char* backend_names = "cpu, gl, gl:egl, gl:osmesa, auto";
std::optional<Backend> backend_of(std::string_view name);

/// Makes renderers that draw as was wished, and where OpenGL cannot, on the CPU. Every choice is told once, in
/// a line with the reason.
class BackendChooser {
 public:
  using Tell = std::function<void(const std::string&)>;

  BackendChooser(Backend wish, Tell tell, const TextureMemoryWish& memory = {});
  ~BackendChooser();
  BackendChooser(const BackendChooser&) = delete;
  BackendChooser& operator=(const BackendChooser&) = delete;

  /// The chooser outlives it and what it makes. All of it belongs to one thread at a time.
  BrickRendererFactory factory();

 private:
  struct Shared;
  class Renderer;

  std::unique_ptr<Shared> shared_;
};

}  // namespace understudy::volume::glsl
