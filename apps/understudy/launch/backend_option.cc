// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/backend_option.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <limits>
#include <string_view>

#include "volume/glsl/brick_size.h"

namespace understudy::launcher {

namespace {

/// 512M becomes 536870912, auto stays; otherwise says what is wrong.
std::string to_bytes(std::string& text) {
  if (text == "auto") return {};
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  const std::string_view unit(rest, std::size_t(end - rest));
  constexpr std::string_view units = "KMGT";
  const std::size_t power = unit.empty() ? 0 : units.find(unit[0]) + 1;
  if (error != std::errc() || unit.size() > 1 || (!unit.empty() && power == 0))
    return fmt::format("'{}' is no size: give bytes, or a whole number and K, M, G or T, or auto", text);
  if (number > std::numeric_limits<std::uint64_t>::max() >> (10 * power))
    return fmt::format("{} is more than there can be", text);
  number <<= 10 * power;
  if (number < volume::glsl::least_texture_memory)
    return fmt::format("{} is too little: one brick of a volume may take {} bytes; give at least {}M", text,
                       volume::glsl::least_texture_memory, (volume::glsl::least_texture_memory >> 20) + 1);
  text = fmt::format("{}", number);
  return {};
}

}  // namespace

void add_backend_option(CLI::App& subcommand, std::string& backend) {
  subcommand
      .add_option("--backend", backend,
                  "what casts the rays of the nodes: cpu, OpenGL on EGL or OSMesa, or auto: the faster one, "
                  "measured. Rendering inside the viewer's process (no -n) always uses the CPU")
      ->check(CLI::IsMember({"cpu", "gl", "gl:egl", "gl:osmesa", "auto"}).description(""))
      ->type_name("cpu|gl|gl:egl|gl:osmesa|auto");
}

void add_gpu_memory_option(CLI::App& subcommand, std::string& gpu_memory) {
  subcommand
      .add_option(
          "--gpu-memory", gpu_memory,
          "what each node's volume may take of a graphics card, in bytes or with K, M, G: of larger ones "
          "only the bricks that are seen are there, and if those are too many, some at a time; auto: half "
          "of what the driver says is free, shared by the nodes, or 4G each where it does not say")
      ->transform(CLI::Validator(to_bytes, "", "size"))
      ->needs(subcommand.get_option("--backend"))
      ->type_name("BYTES|auto");
}

}  // namespace understudy::launcher
