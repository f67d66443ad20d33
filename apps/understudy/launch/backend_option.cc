// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/backend_option.h"

#include <fmt/format.h>

#include "apps/understudy/launch/byte_size.h"
#include "volume/glsl/brick_size.h"

namespace understudy::launcher {

namespace {

std::string to_texture_memory(std::string& text) {
  const std::string given = text;
  if (std::string wrong = to_byte_size(text); !wrong.empty() || text == "auto") return wrong;
  if (byte_size(text) >= volume::glsl::least_texture_memory) return {};
  return fmt::format("{} is too little: one brick of a volume may take {} bytes; give at least {}M", given,
                     volume::glsl::least_texture_memory, (volume::glsl::least_texture_memory >> 20) + 1);
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
      ->transform(CLI::Validator(to_texture_memory, "", "size"))
      ->needs(subcommand.get_option("--backend"))
      ->type_name("BYTES|auto");
}

}  // namespace understudy::launcher
