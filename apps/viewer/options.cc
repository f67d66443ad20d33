// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <map>

#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

constexpr int max_window_edge = 16384;
constexpr int max_frames = 1'000'000;

std::string preset_list() {
  std::string list;
  int number = 0;
  for (const Preset& preset : presets())
    list += fmt::format("\n  {} {}: {}", ++number, preset.name, preset.meaning);
  return list;
}

// CLI11 validators return a message, or an empty string if the text is valid.
const CLI::Validator is_preset(
    [](std::string& text) {
      return find_preset(text) ? std::string()
                               : fmt::format("no preset '{}'; there are:{}", text, preset_list());
    },
    "PRESET");

// Unlike CLI::Range, rejects NaN.
CLI::Validator number_between(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        const bool valid = !text.empty() && *end == '\0' && value >= low && value <= high;
        return valid ? std::string() : fmt::format("{} is not a number from {} to {}", text, low, high);
      },
      fmt::format("FLOAT in [{} - {}]", low, high));
}

/// Options given as words, before they are converted.
struct Texts {
  std::string mode = "table", op = "over", preset = "engine", table, type, surface = "any", step = "whole";
  VolumeSize size{};
  Vec3 spacing{};
  CLI::Option* size_option = nullptr;
  CLI::Option* type_option = nullptr;
  CLI::Option* spacing_option = nullptr;
};

void add_volume_options(CLI::App& app, Options& options, Texts& texts) {
  app.add_option("volume", options.volume_path,
                 "volume file: raw voxels (name.XxYxZ, or with --size), also as .gz; NRRD; or NIfTI")
      ->required();
  texts.size_option = app.add_option("--size", texts.size, "size of a raw file, in voxels")->type_name("X Y Z");
  texts.type_option = app.add_option("--type", texts.type, "voxel type of a raw file")
                          ->check(CLI::IsMember({"u8", "i8", "u16", "i16", "f32"}));
  app.add_flag("--big-endian", options.hints.big_endian,
               "the voxels of a raw file have the most significant byte first");
  texts.spacing_option =
      app.add_option("--spacing", texts.spacing,
                     "distances between voxels along x, y and z, instead of those in the file")
          ->type_name("X Y Z");
}

void add_mode_options(CLI::App& app, Options& options, Texts& texts) {
  app.add_option(
         "--mode", texts.mode,
         "method of drawing the volume: rgba (colours per voxel, fixed function), table (1-D table in GLSL "
         "1.20), core (OpenGL 3.3 core), time (a new time step every frame), bricks (many small textures), lit "
         "(directional light), preint (pre-integrated segments) or stacks (2-D textures)")
      ->check(CLI::IsMember({"rgba", "table", "core", "time", "bricks", "lit", "preint", "stacks"}))
      ->capture_default_str();
  app.add_option(
         "--time-step", texts.step,
         "with --mode time, which voxels change from frame to frame: whole (all of them), part (those in the "
         "middle, and only these are uploaded) or again (those in the middle, but all are uploaded)")
      ->check(CLI::IsMember({"whole", "part", "again"}))
      ->capture_default_str();
  app.add_option("--operator", texts.op, "blending of slices: over, under (front to back), max, min or add")
      ->check(CLI::IsMember({"over", "under", "max", "min", "add"}))
      ->capture_default_str();
  app.add_option("--slices", options.slices,
                 "number of slices across the diagonal of the box (default: one per finest voxel edge)")
      ->check(CLI::Range(1, max_slices));
  app.add_option("--preset", texts.preset, "transfer function, by name or number:" + preset_list())
      ->check(is_preset)
      ->capture_default_str();
  app.add_option(
         "--table", texts.table,
         "transfer function in a JSON file, instead of a preset: control points with values and opacities from "
         "0 to 1, as {\"knots\": [{\"at\": 0.2, \"colour\": [1, 0.5, 0.2], \"opacity\": 0}, ...]}")
      ->type_name("FILE");
}

void add_scene_options(CLI::App& app, Options& options) {
  app.add_flag("--opaque", options.opaque_ball, "draw a solid ball inside the volume");
  app.add_flag("--second", options.second_volume,
               "draw the volume twice, at half its size, the second time in the colours of the next preset");
  app.add_flag("!--no-frame", options.frame_and_axes, "do not draw the frame of the box and the axes");
  app.add_flag("--write-depth", options.write_depth,
               "write the depth of slices that are drawn back to front, as some programs do");
  app.add_option("--background", options.background, "background colour, with components from 0 to 1")
      ->check(number_between(0.0, 1.0))
      ->type_name("R G B");
}

void add_camera_options(CLI::App& app, Options& options) {
  app.add_option("--azimuth", options.camera.azimuth, "azimuth of the camera around the z axis, in degrees")
      ->check(number_between(-1e6, 1e6))
      ->capture_default_str();
  app.add_option("--elevation", options.camera.elevation,
                 "elevation of the camera above the xy plane, in degrees")
      ->check(number_between(-90.0, 90.0))
      ->capture_default_str();
  app.add_option("--distance", options.camera.distance,
                 "distance from the eye to the centre of the box, in box diagonals")
      ->check(number_between(min_distance, max_distance))
      ->capture_default_str();
  app.add_option("--field-of-view", options.camera.field_of_view,
                 "field of view across the shorter side of the image, in degrees")
      ->check(number_between(1.0, 170.0))
      ->capture_default_str();
  app.add_flag("--ortho", options.camera.orthographic,
               "use an orthographic projection instead of a perspective one");
  app.add_option("--window-size", options.window_size, "size of the image, in pixels")
      ->check(CLI::Range(1, max_window_edge))
      ->type_name("W H")
      ->capture_default_str();
}

void add_output_options(CLI::App& app, Options& options, Texts& texts) {
  app.add_flag("--offscreen", options.offscreen, "draw with EGL, without a window or a display");
  app.add_option("--offscreen-surface", texts.surface, "surface to draw into with --offscreen")
      ->check(CLI::IsMember({"any", "pbuffer", "framebuffer"}))
      ->capture_default_str();
  app.add_option("--frames", options.frames,
                 "exit after this many frames (default: 1 off screen or with a screenshot or description, "
                 "otherwise when the window is closed)")
      ->check(CLI::Range(1, max_frames));
  app.add_option("--orbit", options.orbit, "degrees of azimuth to turn from one frame to the next")
      ->check(number_between(-1e6, 1e6));
  app.add_option("--screenshot", options.screenshot, "PNG file for the last frame");
  app.add_option("--screenshot-frames", options.screenshot_folder, "folder for all frames, as frame_NNNN.png");
  app.add_option("--describe", options.description,
                 "JSON file for the data that are needed to recompute the last frame");
  app.add_flag("--print-times", options.print_times,
               "print the time of each frame, and the median, in milliseconds");
}

void take(const Texts& texts, Options& options) {
  if (texts.size_option->count() > 0) options.hints.size = texts.size;
  if (texts.type_option->count() > 0) options.hints.type = scalar_type_named(texts.type);
  if (texts.spacing_option->count() > 0) options.hints.spacing = texts.spacing;
  options.mode = *mode_named(texts.mode);
  options.time_step = std::map<std::string, TimeStep>{
      {"whole", TimeStep::whole},
      {"part", TimeStep::part},
      {"again",
       TimeStep::again}}.at(texts.step);
  options.op = *operator_named(texts.op);
  options.preset = find_preset(texts.preset);
  if (!texts.table.empty()) {
    options.preset_file = std::make_shared<const PresetFile>(texts.table);
    options.preset = &options.preset_file->preset();
  }
  options.surface = std::map<std::string, OffscreenSurface>{{"any", OffscreenSurface::any},
                                                            {"pbuffer", OffscreenSurface::pbuffer},
                                                            {"framebuffer", OffscreenSurface::framebuffer}}
                        .at(texts.surface);
}

}  // namespace

std::optional<int> parse_command_line(int argc, const char* const* argv, Options& options) {
  CLI::App app{"Shows a volume as slices through textures, in a window or off screen."};
  app.name("understudy-viewer");
  app.set_help_flag("-h,--help", "print this help and exit");
  Texts texts;
  add_volume_options(app, options, texts);
  add_mode_options(app, options, texts);
  add_scene_options(app, options);
  add_camera_options(app, options);
  add_output_options(app, options, texts);
  app.footer(
      "Drag with the left mouse button to rotate, and with the right one (or turn the wheel) to zoom. Keys:\n"
      "1 to 5 select a preset, o toggles orthographic projection, q and Esc quit.\n"
      "Exit status: 0 success, 1 a file is missing, damaged or unsuitable, 2 wrong options, 3 no OpenGL.");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? static_cast<int>(ExitCode::success)
                                : static_cast<int>(ExitCode::bad_command_line);
  }

  take(texts, options);
  const bool leaves_something =
      !options.screenshot.empty() || !options.screenshot_folder.empty() || !options.description.empty();
  if (options.frames == 0 && (options.offscreen || leaves_something)) options.frames = 1;
  return std::nullopt;
}

}  // namespace viewer
