// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/study/study.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>

#include "apps/understudy/file_scene/control_points_file.h"
#include "apps/understudy/images/image.h"
#include "apps/understudy/processes/child_process.h"
#include "apps/understudy/processes/installation.h"
#include "apps/understudy/progress/progress_option.h"
#include "apps/understudy/study/other_programs.h"
#include "apps/understudy/study/results.h"
#include "volume/opening/open_volume.h"

namespace understudy::launcher {
namespace {

using namespace study;
namespace fs = std::filesystem;

constexpr int quick_edge = 256, whole_edge = 512;
constexpr int quick_stride = 13, whole_stride = 13;
/// Number of timed images, which alternate between all cameras.
constexpr int quick_repetitions = 5, whole_repetitions = 15;
/// Estimated fraction of the work on a scene that its reference takes.
constexpr double reference_share = 0.6;
/// Estimated fraction of the work on a scene that our settings take.
constexpr double settings_share = 0.3;
constexpr int page_patience_ms = 120000;

struct StudyArguments {
  std::vector<std::string> scenes;
  std::vector<std::string> volumes;  ///< each is FILE or FILE,TABLE
  std::string out = "out/study";
  bool quick = false;
  bool fresh = false;
  bool alone = false;
  int edge = 0;
  ProgressOptions progress;
};

/// Shows the progress of all scenes, and the remaining time.
class StudyProgress {
 public:
  StudyProgress(std::size_t scenes, ProgressStyle style) : scenes_(scenes), progress_(style) {}

  void begin(std::size_t scene, const std::string& name) {
    scene_ = scene;
    name_ = name;
  }
  /// `done` is the fraction of the scene that is done. May be called from any thread.
  void show(double done, const std::string& what) {
    const double all = (double(scene_) + done) / double(scenes_);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start_;
    const int left = all > 0.02 ? int(spent.count() * (1 - all) / all) : -1;
    progress_.show(all, fmt::format("study {:3.0f} %  {}: {}{}", 100 * all, name_, what,
                                    left < 0 ? "" : fmt::format("  {}:{:02} left", left / 60, left % 60)));
  }

 private:
  std::size_t scenes_;
  Progress progress_;
  std::size_t scene_ = 0;
  std::string name_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::vector<SceneDescription> scenes_of(const StudyArguments& arguments) {
  std::vector<SceneDescription> all;
  for (const SceneDescription& scene : built_in_scenes())
    if (arguments.scenes.empty() || std::ranges::find(arguments.scenes, scene.name) != arguments.scenes.end())
      all.push_back(scene);
  for (const std::string& name : arguments.scenes)
    if (std::ranges::find(all, name, &SceneDescription::name) == all.end()) {
      std::string names;
      for (const SceneDescription& scene : built_in_scenes()) names += " " + scene.name;
      throw std::invalid_argument(fmt::format("there is no scene '{}'; give one of{}", name, names));
    }
  for (const std::string& given : arguments.volumes) {
    const std::size_t comma = given.rfind(',');
    const std::string file = given.substr(0, comma);
    const std::string table = comma == std::string::npos ? "grey" : given.substr(comma + 1);
    const std::string file_name = fs::path(file).filename().string();
    const std::string stem = file_name.substr(0, file_name.find_first_of("._"));
    // Results are kept by name: "engine", "engine-2" where a second volume or table has the same.
    std::string name = stem;
    for (int number = 2; std::ranges::find(all, name, &SceneDescription::name) != all.end(); ++number)
      name = fmt::format("{}-{}", stem, number);
    all.push_back({name, "table " + table, file, read_control_points(table), {}});
  }
  return all;
}

/// Writes errors as colours from black (at most 1e-6) over red and yellow to white (0.1 and more); each
/// decade is a fifth of the scale.
void write_error_map(const fs::path& path, const Scene& scene, const Scene::Rays& rays) {
  constexpr int pixels_a_ray = 12;
  const int across = scene.rays_across();
  RgbaImage image;
  image.width = image.height = across * pixels_a_ray;
  image.rgba.assign(std::size_t(4) * std::size_t(image.width) * std::size_t(image.height), 1);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto ray =
          std::size_t(across - 1 - y / pixels_a_ray) * std::size_t(across) + std::size_t(x / pixels_a_ray);
      double error = 0;
      for (std::size_t k = 0; k < 4; ++k)
        error = std::max(error, std::abs(rays[ray][k] - scene.exact()[ray][k]));
      const auto heat = float(std::clamp((std::log10(std::max(error, 1e-9)) + 6) / 5, 0.0, 1.0));
      for (int k = 0; k < 3; ++k) image.pixel(x, y)[k] = std::clamp(3 * heat - float(k), 0.0F, 1.0F);
    }
  write_png(path, image);
}

bool is_ours(const Setting& setting) {
  return !is_other_program(setting.scheme) && setting.scheme != Scheme::eight_bit_slices;
}

bool has_error_map(const Setting& setting) {
  return setting.step == 1 && (setting.termination < 1e-4);
}

/// Returns the settings that can be measured and are not yet in `results`; records there why
/// others cannot be measured.
std::vector<Setting> missing_settings(SceneResults& results, bool quick, OtherPrograms* others) {
  std::vector<Setting> missing;
  results.absent.clear();
  for (const Setting& setting : settings(quick)) {
    if (results.find(setting) != nullptr) continue;
    std::optional<std::string> absence;
    if (is_other_program(setting.scheme))
      absence = others == nullptr ? "not measured, because of --alone" : others->absence(setting.scheme);
    if (absence)
      results.absent[name_of(setting.scheme)] = *absence;
    else
      missing.push_back(setting);
  }
  return missing;
}

/// Writes the error map of the first camera's rays, if `setting` has one.
void add_error_map(const Setting& setting, const Scene& scene, const Scene::Rays& rays, SceneResults& results,
                   const fs::path& folder) {
  if (!has_error_map(setting)) return;
  std::string file = fmt::format("{}_{}.png", results.name, text_of(setting));
  std::ranges::replace_if(
      file, [](char c) { return std::string_view(" ,()'").find(c) != std::string_view::npos; }, '-');
  write_error_map(folder / file, scene, rays);
  results.error_maps[text_of(setting)] = file;
}

/// Measures our settings: first the error of each, then their times, for which they take turns.
void study_ours(const std::vector<Setting>& ours, const Scene& scene, SceneResults& results,
                const fs::path& folder, int repetitions, const std::function<void(double done)>& progress) {
  std::vector<std::unique_ptr<Measurement>> measurements;
  const auto work = double(ours.size() * std::size_t(1 + repetitions));
  double done = 0;
  for (const Setting& setting : ours) {
    progress(done++ / work);
    measurements.push_back(std::make_unique<Measurement>(scene, setting));
    add_error_map(setting, scene, measurements.back()->rays(), results, folder);
  }
  for (int round = 0; round < repetitions; ++round) {
    for (const auto& measurement : measurements) {
      progress(done++ / work);
      measurement->render();
    }
  }
  for (const auto& measurement : measurements) results.points.push_back(measurement->point());
}

/// Adds the point of another program, or of slices in eight bits, and its error map if it has one.
void study_other(const Setting& setting, const Scene& scene, SceneResults& results, const fs::path& folder,
                 OtherPrograms* others) {
  Scene::Rays rays;
  try {
    results.points.push_back(is_other_program(setting.scheme) ? others->measure(scene, setting, rays)
                                                              : measure(scene, setting, 0, rays));
  } catch (const std::runtime_error& error) {
    if (!is_other_program(setting.scheme)) throw;
    results.absent[name_of(setting.scheme)] = error.what();
    return;
  }
  add_error_map(setting, scene, rays, results, folder);
}

void study_scene(const SceneDescription& description, SceneResults& results, Results& all,
                 const fs::path& folder, const StudyArguments& arguments, OtherPrograms* others,
                 bool with_savings, StudyProgress& progress) {
  std::vector<Setting> missing = missing_settings(results, arguments.quick, others);
  const bool optimizations_of =
      with_savings &&
      (results.savings.empty() ||
       std::ranges::any_of(results.savings, [](const Saving& saving) { return !saving.absent.empty(); }));
  if (missing.empty() && !optimizations_of) return;
  progress.show(0, "reading");
  Scene scene(description, all.edge, all.stride);
  if (optimizations_of) {
    results.savings = savings_of(scene, folder / "left-out", [&](const std::string& item) {
      progress.show(0, "without the optimization " + item);
    });
    write_results(folder, all);
  }
  if (missing.empty()) return;
  scene.integrate([&](double done) { progress.show(reference_share * done, "reference"); });
  if (std::ranges::all_of(scene.exact(), [](const auto& ray) { return *std::ranges::max_element(ray) <= 0; }))
    throw std::invalid_argument(
        fmt::format("{}: nothing of {} is visible ({}); give another table or another volume", description.name,
                    description.volume, description.shows));
  results.size = scene.size();
  results.rays = int(scene.exact().size());
  results.reference_seconds = scene.reference_seconds();
  results.stiffness = scene.stiffness();
  const auto others_begin = std::stable_partition(missing.begin(), missing.end(), is_ours);
  study_ours({missing.begin(), others_begin}, scene, results, folder,
             arguments.quick ? quick_repetitions : whole_repetitions,
             [&](double done) { progress.show(reference_share + settings_share * done, "settings"); });
  for (auto setting = others_begin; setting != missing.end(); ++setting) {
    progress.show(reference_share + settings_share, text_of(*setting));
    study_other(*setting, scene, results, folder, others);
  }
  mark_front(results.points);
  write_results(folder, all);
}

/// Makes index.html with the script in the data folder.
int write_page(const fs::path& folder) {
  const fs::path script = this_installation().data / "study_page.py";
  // The system's python comes first, because Debian installs matplotlib for it.
  const fs::path python = fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
  int status = 1;
  try {
    ChildProcess page(
        {{python.string(), "-B", script.string(), folder.string()}, current_environment(), {}, false});
    status = page.wait_for_ending(page_patience_ms).value_or(Ending{1}).exit_status();
  } catch (const std::system_error&) {
    status = 127;
  }
  if (status != 0)
    fmt::print(stderr,
               "study: {} and study.csv were written, but not index.html, which needs python3 and matplotlib; "
               "apt install python3-matplotlib, then repeat the command, which measures nothing twice\n",
               (folder / "study.json").string());
  return status == 0 ? 0 : 1;
}

std::string text_of(const char* what, const std::optional<Ratio>& ratio, const char* never) {
  if (!ratio) return never;
  return fmt::format("{}{} {:.3g}", ratio->at_least ? "at least " : "", what, ratio->value);
}

void print_advantages(const SceneResults& scene) {
  for (const Point& point : scene.points) {
    if (!is_other_program(point.setting.scheme)) continue;
    fmt::print("  {:<44} {:8.2f} ms   RMS {:.1e} of colour", name_of(point.setting.scheme), point.time_ms,
               point.error.colour);
    if (const auto advantage = advantage_over(scene.points, point.setting.scheme))
      fmt::print("; our advantage in time at equal error: {}, in error at equal time: {}",
                 text_of("a factor of", advantage->time, "none, since no setting is as exact"),
                 text_of("a factor of", advantage->error, "none, since no setting is as fast"));
    fmt::print("\n");
  }
  for (const auto& [program, why] : scene.absent) fmt::print("  {:<44} absent: {}\n", program, why);
}

void print_savings(const SceneResults& scene) {
  if (!scene.savings.empty()) fmt::print("  skipped work, and frame times with and without skipping it:\n");
  for (const Saving& saving : scene.savings) {
    if (!saving.absent.empty())
      fmt::print("  {:<20} absent: {}\n", saving.item, saving.absent);
    else
      fmt::print("  {:<20} {:5.1f} % of {} {}: {:.2f} ms a frame, {:.2f} without; images differ by {:.1e}\n",
                 saving.item, saving.all > 0 ? 100 * double(saving.left_out) / double(saving.all) : 0,
                 saving.all, saving.unit, saving.ms, saving.ms_without, saving.difference);
  }
}

/// Measures what is not yet in `results`; writes the results to the folder after each scene.
void study_scenes(const std::vector<SceneDescription>& scenes, const StudyArguments& arguments,
                  const fs::path& folder, Results& results) {
  std::optional<OtherPrograms> others;
  if (!arguments.alone) others.emplace(folder / "other-programs");
  // A quick study measures optimizations on one scene only: the first one from a file.
  const auto from_file = std::ranges::find_if(
      scenes, [](const SceneDescription& scene) { return !scene.volume.starts_with("synthetic:"); });
  const std::size_t looked_into = from_file == scenes.end() ? 0 : std::size_t(from_file - scenes.begin());
  StudyProgress progress(scenes.size(), arguments.progress.style());
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const SceneDescription& scene = scenes[i];
    std::erase_if(results.scenes, [&](const SceneResults& earlier) {
      return earlier.name == scene.name && (earlier.volume != scene.volume || earlier.shows != scene.shows);
    });
    auto found = std::ranges::find(results.scenes, scene.name, &SceneResults::name);
    if (found == results.scenes.end())
      found = results.scenes.insert(found, {scene.name, scene.shows, scene.volume});
    progress.begin(i, scene.name);
    const bool with_savings = !arguments.alone && (i == looked_into || !arguments.quick);
    study_scene(scene, *found, results, folder, arguments, others ? &*others : nullptr, with_savings, progress);
  }
}

void print_results(const Results& results) {
  for (const SceneResults& scene : results.scenes) {
    fmt::print(
        "{}: {} rays, reference {:.1f} s ({:.0f} rays/s); optical depth of a voxel up to {:.3g}, change of "
        "opacity between voxels up to {:.3g}\n",
        scene.name, scene.rays, scene.reference_seconds, scene.rays / std::max(scene.reference_seconds, 1e-9),
        scene.stiffness.depth, scene.stiffness.change);
    for (const Point& point : scene.points)
      if (point.front)
        fmt::print("  {:<44} {:8.2f} ms   RMS {:.1e}   99 % {:.1e}   max {:.1e}\n", text_of(point.setting),
                   point.time_ms, point.error.rms, point.error.quantiles[2], point.error.max);
    print_advantages(scene);
    print_savings(scene);
  }
}

int run_study(const StudyArguments& arguments) {
  const std::vector<SceneDescription> scenes = scenes_of(arguments);
  // A wrong path is reported now, not when its turn comes.
  for (const SceneDescription& scene : scenes) volume::open_volume(scene.volume);
  const fs::path folder = arguments.out;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || ::access(folder.c_str(), W_OK) != 0)
    throw std::runtime_error(
        fmt::format("{}: not a folder that can be written to; give another one with --out", folder.string()));
  const int edge = arguments.edge > 0 ? arguments.edge : arguments.quick ? quick_edge : whole_edge;
  const int stride = std::min(arguments.quick ? quick_stride : whole_stride, edge);
  Results results = arguments.fresh ? Results{edge, stride, {}} : read_results(folder, edge, stride);
  study_scenes(scenes, arguments, folder, results);
  const int status = write_page(folder);
  if (arguments.progress.quiet) return status;
  print_results(results);
  if (status == 0) fmt::print("{}\n", (folder / "index.html").string());
  return status;
}

}  // namespace

void add_study(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<StudyArguments>();
  CLI::App* command = app.add_subcommand(
      "study",
      "measures error and run time of many settings on several scenes, and writes tables, plots and a page");
  command->add_option("--scene", arguments->scenes, "study only these built-in scenes")->type_name("NAME");
  command
      ->add_option("--volume", arguments->volumes,
                   "add a volume file as a scene, with a built-in transfer function (default: grey) or one in "
                   "a file of control points")
      ->type_name("FILE[,TABLE]");
  command->add_flag("--quick", arguments->quick, "use fewer settings, smaller images and fewer repetitions");
  command
      ->add_option("--size", arguments->edge, "edge of the images, in pixels (default: 512, with --quick 256)")
      ->check(CLI::Range(8, 4096));
  command->add_flag("--fresh", arguments->fresh,
                    "repeat what an earlier study in the folder of --out has measured");
  command->add_flag("--alone", arguments->alone, "do not run the bundled viewer and VTK for comparison");
  command->add_option("--out", arguments->out, "folder for study.json, study.csv, error maps and index.html")
      ->type_name("DIR")
      ->capture_default_str();
  add_progress_options(*command, arguments->progress);
  command->callback([arguments, &chosen] { chosen = [arguments] { return run_study(*arguments); }; });
}

}  // namespace understudy::launcher
