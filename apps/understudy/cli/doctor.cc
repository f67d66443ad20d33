// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/doctor.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glx.h>
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/understudy/processes/installation.h"

namespace understudy::launcher {
namespace {

constexpr unsigned probe_seconds = 15;

struct Finding {
  bool works = false;
  std::string what;  ///< what was found, or what is missing
};

struct Check {
  const char* name;
  Finding (*look)();
  const char* fix;
};

/// A library that is opened when asked for, so that this program starts where it is missing.
class Library {
 public:
  explicit Library(const char* name) : handle_(dlopen(name, RTLD_NOW | RTLD_LOCAL)) {}
  explicit operator bool() const { return handle_ != nullptr; }
  template <typename Function>
  Function function(const char* name) const {
    return reinterpret_cast<Function>(dlsym(handle_, name));
  }

 private:
  void* handle_;  // never closed: drivers do not like it, and the probe's process ends soon
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
    return {false, "the X server gives no OpenGL context"};
  }
  return described(gl.function<GetString>("glGetString"));
}

Finding look_at_egl() {
  const Library egl("libEGL.so.1");
  if (!egl) return {false, "libEGL.so.1 is missing"};
  const auto get_platform_display = egl.function<decltype(&eglGetPlatformDisplay)>("eglGetPlatformDisplay");
  if (get_platform_display == nullptr) return {false, "EGL is older than 1.5"};
  const EGLDisplay display = get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  const auto initialize = egl.function<decltype(&eglInitialize)>("eglInitialize");
  if (display == EGL_NO_DISPLAY || initialize(display, nullptr, nullptr) == EGL_FALSE) {
    return {false, "no display without a window system (EGL_PLATFORM_SURFACELESS_MESA)"};
  }
  egl.function<decltype(&eglBindAPI)>("eglBindAPI")(EGL_OPENGL_API);
  const std::array<EGLint, 3> wanted{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  egl.function<decltype(&eglChooseConfig)>("eglChooseConfig")(display, wanted.data(), &config, 1, &configs);
  const EGLContext context = egl.function<decltype(&eglCreateContext)>("eglCreateContext")(
      display, configs > 0 ? config : nullptr, EGL_NO_CONTEXT, nullptr);
  if (context == EGL_NO_CONTEXT || egl.function<decltype(&eglMakeCurrent)>("eglMakeCurrent")(
                                       display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE) {
    return {false, "no desktop OpenGL context without a surface"};
  }
  const auto get_address = egl.function<decltype(&eglGetProcAddress)>("eglGetProcAddress");
  return described(reinterpret_cast<GetString>(get_address("glGetString")));
}

Finding look_at_osmesa() {
  const Library osmesa("libOSMesa.so.8");
  if (!osmesa) return {false, "libOSMesa.so.8 is missing"};
  const OSMesaContext context = osmesa.function<decltype(&OSMesaCreateContextExt)>("OSMesaCreateContextExt")(
      OSMESA_RGBA, 24, 0, 0, nullptr);
  std::array<GLubyte, 16 * 16 * 4> image{};
  if (context == nullptr || osmesa.function<decltype(&OSMesaMakeCurrent)>("OSMesaMakeCurrent")(
                                context, image.data(), GL_UNSIGNED_BYTE, 16, 16) == GL_FALSE) {
    return {false, "gives no OpenGL context"};
  }
  const auto get_address = osmesa.function<decltype(&OSMesaGetProcAddress)>("OSMesaGetProcAddress");
  return described(reinterpret_cast<GetString>(get_address("glGetString")));
}

Finding look_at_mpi() {
  const auto mpirun = program_on_path("mpirun");
  if (!mpirun) return {false, "mpirun is not on PATH"};
  std::array<char, 256> line{};
  if (std::FILE* output = popen("mpirun --version 2>&1", "r")) {
    if (std::fgets(line.data(), line.size(), output) == nullptr) line[0] = '\0';
    pclose(output);
  }
  line[std::strcspn(line.data(), "\n")] = '\0';
  return {true, fmt::format("{} at {}; between hosts it encrypts nothing", line.data(), mpirun->string())};
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

constexpr std::array checks{
    Check{"injection methods", look_at_injection_methods, "./run build"},
    Check{"X", look_at_x,
          "apt install xvfb; Xvfb :99 -screen 0 1280x1024x24 +extension GLX -noreset & export DISPLAY=:99"},
    Check{"GLX", look_at_glx, "apt install libgl1 libglx-mesa0 libgl1-mesa-dri"},
    Check{"EGL", look_at_egl, "apt install libegl1 libegl-mesa0 libgl1-mesa-dri"},
    Check{"OSMesa", look_at_osmesa, "apt install libosmesa6"},
    Check{"MPI", look_at_mpi, "apt install openmpi-bin libopenmpi-dev"},
    Check{"nodes", look_at_nodes, "apt install libopenmpi-dev openmpi-bin && ./run build"},
};

/// Drivers may crash, hang or end their process: each check runs in a process of its own.
Finding look_apart(const Check& check) {
  std::array<int, 2> channel{};
  if (pipe(channel.data()) != 0) return {false, std::strerror(errno)};
  const pid_t probe = fork();
  if (probe == 0) {
    alarm(probe_seconds);
    const Finding finding = check.look();
    const std::string message = (finding.works ? "+" : "-") + finding.what;
    (void)!write(channel[1], message.data(), message.size());
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
    return {false, WIFSIGNALED(status)
                       ? fmt::format("its library was killed by {}", strsignal(WTERMSIG(status)))
                       : std::string("its library ended the process")};
  }
  return {message.front() == '+', message.substr(1)};
}

int doctor() {
  for (const Check& check : checks) {
    const Finding finding = look_apart(check);
    if (finding.works) {
      fmt::print("ok       {:18}{}\n", check.name, finding.what);
    } else {
      fmt::print("missing  {:18}{}; fix: {}\n", check.name, finding.what, check.fix);
    }
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

void add_doctor(CLI::App& app, std::function<int()>& chosen) {
  app.add_subcommand("doctor", "what of OpenGL, X, MPI works here, and how to mend what does not")
      ->callback([&chosen] { chosen = doctor; });
}

}  // namespace understudy::launcher
