// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/pipeline/assembly_parameters.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "spu/volume/pipeline/built_in_uniform.h"

namespace understudy::spu {
namespace {

/// Kinds of state, and a built-in uniform of GLSL that shows the same. The camera's matrices are not among
/// them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kinds_of_state{{
    {"state.material", "gl_FrontMaterial"},
    {"state.light", "gl_LightSource"},
    {"state.fog.", "gl_Fog"},
    {"state.texenv", "gl_TextureEnvColor"},
    {"state.matrix.texture", "gl_TextureMatrix"},
    {"state.clip", "gl_ClipPlane"},
    {"state.point", "gl_Point"},
    {"state.depth.range", "gl_DepthRange"},
}};

/// Returns n of "BEGINNINGn]".
std::optional<GLuint> index_after(std::string_view beginning, std::string_view name) {
  if (!name.starts_with(beginning) || !name.ends_with(']')) return std::nullopt;
  const char* const end = name.data() + name.size() - 1;
  GLuint index = 0;
  const auto [read, error] = std::from_chars(name.data() + beginning.size(), end, index);
  if (error != std::errc() || read != end) return std::nullopt;
  return index;
}

}  // namespace

std::vector<double> assembly_parameter(const DispatchTable& gl, std::string_view name) {
  const auto read = [](GLuint index, const auto& get) {
    std::array<GLfloat, 4> value{};
    get(GL_FRAGMENT_PROGRAM_ARB, index, value.data());
    return std::vector<double>(value.begin(), value.end());
  };
  if (const auto index = index_after("program.local[", name))
    return read(*index, gl.GetProgramLocalParameterfvARB);
  if (const auto index = index_after("program.env[", name)) return read(*index, gl.GetProgramEnvParameterfvARB);
  const auto kind =
      std::ranges::find_if(kinds_of_state, [&](const auto& each) { return name.starts_with(each.first); });
  return kind == kinds_of_state.end() ? std::vector<double>() : built_in_uniform(gl, kind->second);
}

bool is_assembly_state(std::string_view name) {
  return name.starts_with("state.");
}

}  // namespace understudy::spu
