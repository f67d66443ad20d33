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
  return fmt::format("{} is too little, since one brick of a volume may take {} bytes; give at least {}M",
                     given, volume::glsl::least_texture_memory, (volume::glsl::least_texture_memory >> 20) + 1);
}

}  // namespace

void add_backend_option(CLI::App& subcommand, std::string& backend) {
  subcommand
      .add_option("--backend", backend,
                  "backend that casts the rays on the nodes: cpu (default), gl (OpenGL on EGL, or on OSMesa "
                  "without EGL), gl:egl, gl:osmesa, or auto (CPU or OpenGL, whichever is measured to be "
                  "faster); rendering inside the viewer's process (without -n) always uses the CPU")
      ->check(CLI::IsMember({"cpu", "gl", "gl:egl", "gl:osmesa", "auto"}).description(""))
      ->type_name("cpu|gl|gl:egl|gl:osmesa|auto");
}

void add_gpu_memory_option(CLI::App& subcommand, std::string& gpu_memory) {
  subcommand
      .add_option("--gpu-memory", gpu_memory,
                  "graphics memory for each node's volume, in bytes, or with K, M, G or T; of a larger volume, "
                  "only the visible bricks are loaded, and if these are too large as well, some at a time; "
                  "auto (default): half of the memory that the driver reports as free, shared by the nodes, or "
                  "4G for each node if the driver reports nothing")
      ->transform(CLI::Validator(to_texture_memory, "", "size"))
      ->needs(subcommand.get_option("--backend"))
      ->type_name("BYTES|auto");
}

}  // namespace understudy::launcher
