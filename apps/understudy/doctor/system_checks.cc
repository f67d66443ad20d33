// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/doctor/system_checks.h"

#include <GL/glx.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/understudy/hosts/mpi_launcher.h"
#include "apps/understudy/processes/installation.h"
#include "apps/understudy/sandbox/sandbox.h"
#include "volume/offscreen/egl.h"
#include "volume/offscreen/osmesa.h"

namespace understudy::launcher {
namespace {

constexpr unsigned probe_seconds = 15;

struct Check {
  const char* name;
  Finding (*look)();
  const char* fix;
};

/// A library that is opened at run time, so that this program starts without it.
class Library {
 public:
  explicit Library(const char* name) : handle_(dlopen(name, RTLD_NOW | RTLD_LOCAL)) {}
  explicit operator bool() const { return handle_ != nullptr; }
  template <typename Function>
  Function function(const char* name) const {
    return reinterpret_cast<Function>(dlsym(handle_, name));
  }

 private:
  void* handle_;  // never closed, because some drivers crash then; the probe's process ends soon
};

using GetString = const GLubyte* (*)(GLenum);

Finding described(GetString get_string) {
  if (get_string == nullptr) return {false, "glGetString is missing"};
  const auto text = [&](GLenum name) {
    const auto* value = reinterpret_cast<const char*>(get_string(name));
    return std::string(value != nullptr ? value : "?");
  };
  return {true, fmt::format("OpenGL {}, {}", text(GL_VERSION), text(GL_RENDERER))};
}

Finding look_at_x() {
  const char* name = std::getenv("DISPLAY");
  if (name == nullptr) return {false, "DISPLAY is not set"};
  const Library x11("libX11.so.6");
  if (!x11) return {false, "libX11.so.6 is missing"};
  Display* display = x11.function<decltype(&XOpenDisplay)>("XOpenDisplay")(nullptr);
  if (display == nullptr) return {false, fmt::format("no X server answers at DISPLAY={}", name)};
  return {true, fmt::format("X server at {}", name)};
}

Finding look_at_glx() {
  if (const Finding x = look_at_x(); !x.works) return {false, "needs X: " + x.what};
  const Library x11("libX11.so.6");
  const Library gl("libGL.so.1");
  if (!gl) return {false, "libGL.so.1 is missing"};
  Display* display = x11.function<decltype(&XOpenDisplay)>("XOpenDisplay")(nullptr);
  std::array<int, 6> wanted{GLX_RGBA, GLX_DOUBLEBUFFER, GLX_DEPTH_SIZE, 16, None, None};
  XVisualInfo* visual = gl.function<decltype(&glXChooseVisual)>("glXChooseVisual")(display, 0, wanted.data());
  if (visual == nullptr) return {false, "the X server offers no visual with OpenGL"};
  XSetWindowAttributes attributes{};
  const Window root = RootWindow(display, visual->screen);
  attributes.colormap =
      x11.function<decltype(&XCreateColormap)>("XCreateColormap")(display, root, visual->visual, AllocNone);
  const Window window = x11.function<decltype(&XCreateWindow)>("XCreateWindow")(
      display, root, 0, 0, 16, 16, 0, visual->depth, InputOutput, visual->visual, CWColormap | CWBorderPixel,
      &attributes);
  const GLXContext context =
      gl.function<decltype(&glXCreateContext)>("glXCreateContext")(display, visual, nullptr, True);
  if (context == nullptr ||
      gl.function<decltype(&glXMakeCurrent)>("glXMakeCurrent")(display, window, context) == False) {
    return {false, "the X server provides no OpenGL context"};
  }
  return described(gl.function<GetString>("glGetString"));
}

Finding look_at_egl() {
  const volume::offscreen::Egl egl;
  egl.open_display(volume::offscreen::Egl::First::surfaceless, "desktop OpenGL context without a surface",
                   [&](EGLDisplay display) {
                     const EGLContext context = egl.create_context(display, {});
                     return context != EGL_NO_CONTEXT &&
                            egl.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
                   });
  return described(reinterpret_cast<GetString>(egl.GetProcAddress("glGetString")));
}

Finding look_at_osmesa() {
  const volume::offscreen::Osmesa osmesa;
  const OSMesaContext context = osmesa.create_context({.depth_bits = 24});
  std::array<GLubyte, 16 * 16 * 4> image{};
  if (context == nullptr || !osmesa.MakeCurrent(context, image.data(), GL_UNSIGNED_BYTE, 16, 16))
    return {false, "libOSMesa provides no OpenGL context"};
  return described(reinterpret_cast<GetString>(osmesa.GetProcAddress("glGetString")));
}

Finding look_at_mpi() {
  const auto family = mpi_of_nodes();
  if (!family) return {false, "Understudy was built without MPI"};
  const auto found = find_mpi_launcher(*family);
  if (const auto* const obstacle = std::get_if<std::string>(&found)) return {false, *obstacle};
  const auto& launcher = std::get<MpiLauncher>(found);
  return {true, fmt::format("{} at {}; its traffic between hosts is not encrypted", launcher.version.text,
                            launcher.program.string())};
}

Finding look_at_nodes() {
  const std::filesystem::path node = this_installation().node();
  if (!std::filesystem::exists(node)) return {false, node.string() + " was not built"};
  return {true, node.string()};
}

Finding look_at_injection_methods() {
  const Installation here = this_installation();
  for (const std::filesystem::path& part : {here.shim(), here.auditor(), here.entry_folder()}) {
    if (!std::filesystem::exists(part)) return {false, part.string() + " was not built"};
  }
  return {true, "audit, preload and folder, in " + here.libraries.string()};
}

/// Returns what is still possible in the sandbox of a GL server's process; empty if the sandbox holds.
std::vector<std::string> escapes() {
  std::vector<std::string> found;
  if (open("/proc/self/status", O_RDONLY | O_CLOEXEC) >= 0) found.emplace_back("files can be opened");
  if (socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0) >= 0) found.emplace_back("sockets can be created");
  if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0) found.emplace_back("processes can be traced");
  // Must be last: if it succeeds, it replaces this program.
  std::array<char*, 1> none{};
  execve("/proc/self/exe", none.data(), none.data());
  if (errno != EPERM) found.emplace_back("programs can be started");
  return found;
}

Finding look_at_sandbox() {
  const SandboxState state = Sandbox({}).close(Renderer::cpu);
  if (!state.obstacle.empty())
    return {false, state.obstacle + "; run --remote and serve --gl-server work without a sandbox"};
  if (const auto found = escapes(); !found.empty()) return {false, fmt::format("{}", fmt::join(found, ", "))};
  const std::string landlock =
      state.landlock > 0 ? fmt::format("and Landlock {}", state.landlock) : "alone; " + state.no_landlock;
  return {true,
          fmt::format("seccomp {}: processes of GL servers cannot open files, start programs or create sockets",
                      landlock)};
}

constexpr std::array checks{
    Check{"injection methods", look_at_injection_methods, "./run build"},
    Check{"X", look_at_x,
          "apt install xvfb; Xvfb :99 -screen 0 1280x1024x24 +extension GLX -noreset & export DISPLAY=:99"},
    Check{"GLX", look_at_glx, "apt install libgl1 libglx-mesa0 libgl1-mesa-dri"},
    Check{"EGL", look_at_egl, "apt install libegl1 libegl-mesa0 libgl1-mesa-dri"},
    Check{"OSMesa", look_at_osmesa, "apt install libosmesa6"},
    Check{"MPI", look_at_mpi,
          "install the MPI that the nodes were built with, or build the nodes with the installed one "
          "(docs/install.md)"},
    Check{"sandbox", look_at_sandbox,
          "use a kernel with CONFIG_SECCOMP_FILTER, or a container that permits seccomp filters"},
    Check{"nodes", look_at_nodes, "apt install libopenmpi-dev openmpi-bin && ./run build"},
};

Finding finding_of(const Check& check) {
  try {
    return check.look();
  } catch (const volume::offscreen::ContextUnavailable& absent) {
    return {false, absent.what()};
  }
}

/// Runs the check in a separate process, because drivers may crash, hang or exit.
Finding look_apart(const Check& check) {
  std::array<int, 2> channel{};
  if (pipe(channel.data()) != 0) return {false, std::strerror(errno)};
  const pid_t probe = fork();
  if (probe == 0) {
    alarm(probe_seconds);
    const Finding finding = finding_of(check);
    const std::string message = (finding.works ? "+" : "-") + finding.what;
    (void)!::write(channel[1], message.data(), message.size());
    _exit(0);
  }
  close(channel[1]);
  std::string message;
  std::array<char, 512> part{};
  for (ssize_t count = 0; (count = read(channel[0], part.data(), part.size())) > 0;) {
    message.append(part.data(), static_cast<std::size_t>(count));
  }
  close(channel[0]);
  int status = 0;
  waitpid(probe, &status, 0);
  if (message.empty()) {
    if (!WIFSIGNALED(status)) return {false, "its library ended the process"};
    if (WTERMSIG(status) == SIGALRM)
      return {false, fmt::format("its library did not answer within {} s", probe_seconds)};
    return {false, fmt::format("its library crashed: {}", strsignal(WTERMSIG(status)))};
  }
  return {message.front() == '+', message.substr(1)};
}

}  // namespace

std::vector<NamedFinding> system_findings(const std::function<void(const NamedFinding&)>& told) {
  std::vector<NamedFinding> findings;
  for (const Check& check : checks) {
    findings.push_back({check.name, look_apart(check), check.fix});
    told(findings.back());
  }
  return findings;
}

}  // namespace understudy::launcher
