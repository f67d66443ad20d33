// SPDX-License-Identifier: Apache-2.0
#include "spu/options.h"

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdio>
#include <optional>

#include "compositor/exchange/settings.h"
#include "compositor/logging/log.h"
#include "spu/former_names.h"

namespace understudy::spu {
namespace {

template <typename Number>
std::optional<Number> number_in(const std::string& text, Number low, Number high) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || !(number >= low && number <= high)) return {};
  return number;
}

template <auto member, int low, int high>
bool set_number(Options& options, const std::string& text) {
  using Number = std::remove_reference_t<decltype(options.*member)>;
  const std::optional<Number> number = number_in<Number>(text, Number{low}, Number{high});
  if (number) options.*member = *number;
  return number.has_value();
}

/// "0.002" or "0.5/255", in (0, 1]; or "none".
bool set_error(Options& options, const std::string& text) {
  if (text == "none") {
    options.error = 0;
    return true;
  }
  const std::size_t slash = text.find('/');
  const auto above = number_in<double>(text.substr(0, slash), 0, 1e9);
  const auto below =
      slash == std::string::npos ? std::optional(1.0) : number_in<double>(text.substr(slash + 1), 0, 1e9);
  if (!above || !below || !(*above > 0 && *above <= *below)) return false;
  options.error = *above / *below;
  return true;
}

/// "30ms", "30" or "0.03s", up to a minute; or "none".
bool set_time(Options& options, const std::string& text) {
  if (text == "none") {
    options.time_ms = 0;
    return true;
  }
  const std::size_t unit = text.find_first_not_of("0123456789.");
  const std::string name = unit == std::string::npos ? "ms" : text.substr(unit);
  const auto number = number_in<double>(text.substr(0, unit), 0, 60000);
  const double ms = number.value_or(0) * (name == "s" ? 1000 : 1);
  if ((name != "ms" && name != "s") || !(ms > 0 && ms <= 60000)) return false;
  options.time_ms = ms;
  return true;
}

bool set_disabled_optimizations(Options& options, const std::string& text) {
  const std::optional<OptimizationSet> optimizations = optimizations_in(text);
  if (optimizations) options.disabled_optimizations = *optimizations;
  return optimizations.has_value();
}

template <auto member>
bool set_text(Options& options, const std::string& text) {
  options.*member = text;
  return true;
}

template <auto member>
bool set_switch(Options& options, const std::string& text) {
  const bool on = text == "1" || text == "on" || text == "yes" || text == "true";
  const bool off = text.empty() || text == "0" || text == "off" || text == "no" || text == "false";
  if (on || off) options.*member = on;
  return on || off;
}

template <auto member, bool (*known)(compositor::ExchangeSettings&, std::string_view)>
bool set_name(Options& options, const std::string& text) {
  compositor::ExchangeSettings scratch;
  if (!known(scratch, text)) return false;
  options.*member = text;
  return true;
}

bool set_server_opengl(Options& options, const std::string& text) {
  if (text != "auto" && text != "egl" && text != "osmesa") return false;
  options.server_opengl = text;
  return true;
}

bool set_control(Options& options, const std::string& text) {
  if (text != "auto" && text != "on" && text != "off") return false;
  options.control = text;
  return true;
}

bool set_sandbox(Options& options, const std::string& text) {
  if (text != "auto" && text != "off") return false;
  options.sandbox = text == "auto";
  return true;
}

struct Row {
  OptionText text;
  bool (*set)(Options&, const std::string&);
};

constexpr std::array rows{
    Row{{"-n,--nodes", "UNDERSTUDY_NODES", "N", "0",
         "number of MPI ranks of this machine to render on; 0 (default) renders inside the viewer, on threads"},
        set_number<&Options::nodes, 0, max_nodes>},
    Row{{"--connect", "UNDERSTUDY_CONNECT", "WHERE", "",
         "render on the nodes of `understudy serve`: its socket, or HOST:PORT on another machine"},
        set_text<&Options::connect>},
    Row{{"--exchange", "UNDERSTUDY_EXCHANGE", "serial|tree|direct-send|binary-swap|radix-k|auto", "auto",
         "exchange that composites the images of the nodes; auto (default): for each image the cheapest one, "
         "by the measured cost of messages and bytes"},
        set_name<&Options::exchange, compositor::set_algorithm>},
    Row{{"--pixels", "UNDERSTUDY_PIXELS", "float|half|byte", "float",
         "pixel format of the exchange: float (exact; default), half (rounded to 1/2048 of a value) or byte "
         "(to 1/510)"},
        set_name<&Options::pixels, compositor::set_layout>},
    Row{{"--gather", "UNDERSTUDY_GATHER", "direct|root", "direct",
         "transfer of the finished parts of an image to the viewer: direct (each node of this machine writes "
         "its part into the viewer's memory; default) or root (one node collects them)"},
        set_name<&Options::gather, compositor::set_gather>},
    Row{{"--overlap", "UNDERSTUDY_OVERLAP", "on|off|auto", "auto",
         "composite parts of an image while other parts are rendered; auto (default): if that was faster so "
         "far"},
        set_name<&Options::overlap, compositor::set_overlap>},
    Row{{"--tiles", "UNDERSTUDY_TILES", "on|off", "off",
         "with --remote, draw everything but volumes in tiles of the window, with one process for each node "
         "and tile"},
        set_switch<&Options::tiles>},
    Row{{"--frame-latency", "UNDERSTUDY_FRAME_LATENCY", "FRAMES", "0",
         "1: while the camera moves, show the image of the previous frame, so that nodes and viewer work at "
         "the same time; when the camera comes to rest, the viewer's window is redrawn; default: 0"},
        set_number<&Options::frame_latency, 0, 1>},
    Row{{"--verify", "UNDERSTUDY_VERIFY", "[K]", "0",
         "compare every K-th frame whole with the viewer's own drawing; without K: every frame; 0 (default): "
         "only after changes that could make an image wrong; -1: never"},
        set_number<&Options::verify, -1, 1'000'000>},
    Row{{"", "UNDERSTUDY_VERIFY_PSNR", "DB", "0",
         "least PSNR of a compared image, in addition to the bound on every tile"},
        set_number<&Options::verify_psnr, 0, 200>},
    Row{{"--speed-guard", "UNDERSTUDY_SPEED_GUARD", "on|off", "on",
         "on (default): let the viewer draw its volume itself where that is faster"},
        set_switch<&Options::speed_guard>},
    Row{{"--report", "UNDERSTUDY_REPORT", "FILE", "", "write the figures of this run as JSON"},
        set_text<&Options::report>},
    Row{{"--explain", "UNDERSTUDY_EXPLAIN", "", "off",
         "print what was recognised of every volume, why draws were not substituted, and which work was "
         "skipped or not, and why"},
        set_switch<&Options::explain>},
    Row{{"--disable-optimization", "UNDERSTUDY_DISABLE_OPTIMIZATION", "LIST", "none",
         "do the named work although it cannot change the image, for comparison: all, or a comma-separated "
         "list of empty-bricks, hidden-samples, dominated-samples, footprints, unchanged-images, "
         "unchanged-texels, known-colours, absent-depth, unseen-depth"},
        set_disabled_optimizations},
    Row{{"--error", "UNDERSTUDY_ERROR", "E", "none",
         "take the fewest samples that keep every channel of every pixel within E of the integral, instead "
         "of the viewer's own samples: a number like 0.002 or a fraction like 0.5/255, above 0 and at most 1"},
        set_error},
    Row{{"--time", "UNDERSTUDY_TIME", "T", "none",
         "take as many samples as can be cast in T per image, instead of the viewer's own samples: 30ms or "
         "0.03s, above 0 and at most a minute; --error takes precedence"},
        set_time},
    Row{{"--save-frames", "UNDERSTUDY_SAVE_FRAMES", "DIR", "",
         "folder to save the composited float images in: frame_0001.pfm and frame_0001_alpha.pfm, …"},
        set_text<&Options::save_frames>},
    Row{{"--export", "UNDERSTUDY_EXPORT", "DIR", "",
         "folder to save each recognised volume in, with camera and transfer function, as a scene for "
         "`understudy render`: scene.json, scene_2.json, …"},
        set_text<&Options::export_folder>},
    Row{{"--debug-tint", "UNDERSTUDY_DEBUG_TINT", "", "off", "tint the pixels that Understudy drew"},
        set_switch<&Options::debug_tint>},
    Row{{"--control", "UNDERSTUDY_CONTROL", "auto|on|off", "auto",
         "let `understudy ctl` control the viewer while it runs; auto (default): under `understudy run`, but "
         "not with plain LD_PRELOAD"},
        set_control},
    Row{{"", "UNDERSTUDY_DISABLE", "", "off", "pass every call to the real OpenGL"},
        set_switch<&Options::disable>},
    Row{{"--chain", "UNDERSTUDY_CHAIN", "TEXT", "track volume driver",
         "stream processing units (SPUs), first to last, with their options, or @FILE.json; for a list: "
         "understudy units"},
        set_text<&Options::chain>},
    Row{{"--server-opengl", "UNDERSTUDY_SERVER_OPENGL", "NAME", "auto",
         "OpenGL library of GL servers and of replayed traces: egl (without a window system), osmesa (on the "
         "CPU, one colour buffer), or auto (default): EGL, or OSMesa if EGL cannot create a context"},
        set_server_opengl},
    Row{{"--sandbox", "UNDERSTUDY_SANDBOX", "auto|off", "auto",
         "auto (default): the process that executes a viewer's calls under --remote cannot open files, start "
         "programs or make connections, if the kernel has seccomp and Landlock (see `understudy doctor`); "
         "off: for drivers that need more"},
        set_sandbox},
    Row{{"", "UNDERSTUDY_RUN_DIR", "DIR", "", "folder of the launcher for this run (set by `understudy run`)"},
        set_text<&Options::run_dir>},
    Row{{"", "UNDERSTUDY_REMOTE", "PATH", "", "socket of the GL server (set by `understudy run --remote`)"},
        set_text<&Options::remote>},
};

constexpr auto texts = [] {
  std::array<OptionText, rows.size()> only_texts{};
  for (std::size_t i = 0; i < rows.size(); ++i) only_texts[i] = rows[i].text;
  return only_texts;
}();

}  // namespace

std::span<const OptionText> option_table() {
  return texts;
}

bool set_option(Options& options, std::string_view environment, const std::string& text) {
  for (const Row& row : rows) {
    if (environment == row.text.environment) return row.set(options, text);
  }
  return false;
}

Options options_from_environment() {
  Options options;
  for (const Row& row : rows) {
    const std::optional<std::string> text = environment_value(row.text.environment);
    if (!text || row.set(options, *text)) continue;
    logging::log(logging::Level::warn, "{}={} is not a value this option takes ({}); using {}",
                 row.text.environment, text->c_str(), row.text.help,
                 *row.text.fallback == '\0' ? "none" : row.text.fallback);
  }
  return options;
}

}  // namespace understudy::spu
