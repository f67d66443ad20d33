// SPDX-License-Identifier: Apache-2.0
#include "spu/tiles/window_use.h"

#include <array>
#include <cstddef>
#include <string_view>

#include "dispatch/table.h"
#include "spu/track/call_role.h"

namespace understudy::spu {
namespace {

/// Whether the call concerns handles of textures or images, which are valid in one process only.
bool gives_handles(std::string_view name) {
  return name.find("TextureHandle") != std::string_view::npos ||
         name.find("TextureSamplerHandle") != std::string_view::npos ||
         name.find("ImageHandle") != std::string_view::npos;
}

WindowUse find_use(CallId call) {
  const std::string_view name = call_name(call);
  if (name == "glFlush" || name == "glFinish") return WindowUse::pushes;
  // Clears a framebuffer that need not be the bound one: drawn whole.
  if (name.starts_with("glClearNamedFramebuffer")) return WindowUse::none;
  // Their names are those of queries, but later calls refer to their answers.
  if (gives_handles(name)) return WindowUse::none;
  if (name == "glBitmap" || name.starts_with("glDrawTex")) return WindowUse::draws;
  if (name.starts_with("glReadPixels") || name.starts_with("glReadnPixels")) return WindowUse::reads;
  if (name.starts_with("glBlit")) return WindowUse::blits;
  if (name.starts_with("glCopyTex") || name.starts_with("glCopyMultiTex") || name == "glCopyPixels" ||
      name.starts_with("glCopyColor") || name.starts_with("glCopyConvolution")) {
    return WindowUse::copies;
  }
  switch (role_of(call)) {
    case CallRole::begin:
      return WindowUse::begins;
    case CallRole::end:
      return WindowUse::ends;
    case CallRole::call_list:
      return WindowUse::lists;
    case CallRole::draw:
      return name.starts_with("glDispatch") ? WindowUse::none : WindowUse::draws;
    case CallRole::ask:
    case CallRole::read:
      return WindowUse::asks;
    default:
      return WindowUse::none;
  }
}

std::array<WindowUse, call_count> all_uses() {
  std::array<WindowUse, call_count> uses{};
  for (std::size_t i = 0; i < call_count; ++i) uses[i] = find_use(CallId(i));
  return uses;
}

/// Calls that may prevent tiles, some of them depending on their arguments.
enum class Obstacle : std::uint8_t {
  none,
  accumulation,
  images,
  handles,
  query,
  buffer,
  draw_buffer,
  draw_buffers
};

Obstacle find_obstacle(CallId call) {
  const std::string_view name = call_name(call);
  if (name == "glAccum") return Obstacle::accumulation;
  if (name.starts_with("glBindImageTexture")) return Obstacle::images;
  if (gives_handles(name)) return Obstacle::handles;
  if (name.starts_with("glBeginQuery") || name.starts_with("glBeginOcclusionQuery")) return Obstacle::query;
  if (name.starts_with("glBindBuffer")) return Obstacle::buffer;
  if (name == "glDrawBuffer" || name == "glFramebufferDrawBufferEXT" || name == "glNamedFramebufferDrawBuffer")
    return Obstacle::draw_buffer;
  if (name.starts_with("glDrawBuffers") || name == "glFramebufferDrawBuffersEXT" ||
      name == "glNamedFramebufferDrawBuffers") {
    return Obstacle::draw_buffers;
  }
  return Obstacle::none;
}

std::array<Obstacle, call_count> all_obstacles() {
  std::array<Obstacle, call_count> obstacles{};
  for (std::size_t i = 0; i < call_count; ++i) obstacles[i] = find_obstacle(CallId(i));
  return obstacles;
}

bool is_front(GLenum buffer) {
  switch (buffer) {
    case GL_FRONT:
    case GL_FRONT_LEFT:
    case GL_FRONT_RIGHT:
    case GL_FRONT_AND_BACK:
    case GL_LEFT:
    case GL_RIGHT:
      return true;
    default:
      return false;
  }
}

/// Whether the query's result depends on the fragments of all tiles.
bool counts_fragments(GLenum query) {
  switch (query) {
    case GL_SAMPLES_PASSED:
    case GL_ANY_SAMPLES_PASSED:
    case GL_ANY_SAMPLES_PASSED_CONSERVATIVE:
    case GL_FRAGMENT_SHADER_INVOCATIONS:
    case GL_CLIPPING_OUTPUT_PRIMITIVES:
      return true;
    default:
      return false;
  }
}

}  // namespace

WindowUse window_use(CallId call) {
  static const std::array<WindowUse, call_count> uses = all_uses();
  return uses[std::size_t(call)];
}

const char* beyond_tiles(CallId call, const std::uint64_t* words) {
  static const std::array<Obstacle, call_count> obstacles = all_obstacles();
  constexpr const char* front = "the application draws into the front buffer";
  switch (obstacles[std::size_t(call)]) {
    case Obstacle::none:
      return nullptr;
    case Obstacle::accumulation:
      return "the application uses the accumulation buffer";
    case Obstacle::images:
      return "shaders of the application write images";
    case Obstacle::handles:
      return "the application uses handles of textures";
    case Obstacle::query:
      return std::string_view(call_name(call)).find("Occlusion") != std::string_view::npos ||
                     counts_fragments(GLenum(words[0]))
                 ? "the application counts samples (occlusion queries)"
                 : nullptr;
    case Obstacle::buffer:
      switch (GLenum(words[0])) {
        case GL_SHADER_STORAGE_BUFFER:
        case GL_ATOMIC_COUNTER_BUFFER:
          return "shaders of the application write buffers";
        case GL_QUERY_BUFFER:
          return "the application has answers written into a buffer";
        default:
          return nullptr;
      }
    case Obstacle::draw_buffer: {
      // The buffer is the last argument, which may follow a framebuffer.
      const std::size_t last = call == CallId::DrawBuffer ? 0 : 1;
      return is_front(GLenum(words[last])) ? front : nullptr;
    }
    case Obstacle::draw_buffers: {
      const std::string_view name = call_name(call);
      const std::size_t count_at = name.starts_with("glDrawBuffers") ? 0 : 1;
      const auto* buffers = reinterpret_cast<const GLenum*>(static_cast<std::uintptr_t>(words[count_at + 1]));
      // The indexed form belongs to OpenGL ES and has two arrays.
      if (name.starts_with("glDrawBuffersIndexed") || buffers == nullptr) return nullptr;
      for (GLsizei i = 0; i < GLsizei(words[count_at]); ++i) {
        if (is_front(buffers[i])) return front;
      }
      return nullptr;
    }
  }
  return nullptr;
}

}  // namespace understudy::spu
