#include "apps/understudy/backend_option.h"

namespace understudy::launcher {

void add_backend_option(CLI::App& subcommand, std::string& backend) {
  subcommand
      .add_option(
          "--backend", backend,
          "who casts the nodes' rays: the CPU, OpenGL on EGL or OSMesa, or the faster one of both, measured; "
          "without nodes it is always the CPU, and so it is unless asked")
      ->check(CLI::IsMember({"cpu", "gl", "gl:egl", "gl:osmesa", "auto"}).description(""))
      ->type_name("cpu|gl|gl:egl|gl:osmesa|auto");
}

}  // namespace understudy::launcher
