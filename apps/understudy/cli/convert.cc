// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/convert.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <string>

#include "apps/understudy/cli/output_file.h"
#include "apps/understudy/file_scene/file_hints.h"
#include "apps/understudy/progress/progress_option.h"
#include "volume/file/volume_file.h"
#include "volume/opening/open_volume.h"

namespace understudy::launcher {
namespace {

struct Arguments {
  std::string volume;
  std::string out;
  FileHintOptions raw;
  int time_step = 0;
  volume::HierarchyOptions options;
  std::string prediction = "cubic";
  ProgressOptions progress;
};

int convert(const Arguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  volume::FileHints hints = file_hints(arguments.raw);
  hints.time_step = arguments.time_step;
  const auto volume = volume::open_volume(arguments.volume, hints);
  volume::HierarchyOptions options = arguments.options;
  options.prediction = arguments.prediction == "cubic" ? volume::Prediction::cubic : volume::Prediction::linear;
  const volume::HierarchyFigures figures = [&] {
    Progress progress(arguments.progress.style());
    return volume::write_hierarchical(*volume, arguments.out, options, [&](double part) {
      progress.show(part, fmt::format("converting {:3} %", int(100 * part)));
    });
  }();
  if (arguments.progress.quiet) return 0;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}: {}{:.2f} s, {:.0f} MB/s\n", arguments.out, figures_text(figures), seconds,
             double(figures.scalar_bytes) / 1e6 / seconds);
  return 0;
}

}  // namespace

std::string figures_text(const volume::HierarchyFigures& figures) {
  std::string text =
      fmt::format("{} bytes, {:.3f} of the volume's {} bytes\n", figures.file_bytes,
                  double(figures.file_bytes) / double(figures.scalar_bytes), figures.scalar_bytes);
  for (std::size_t level = 0; level < figures.levels.size(); ++level) {
    const volume::HierarchyFigures::Level& of = figures.levels[level];
    text += fmt::format("level {}: {} x {} x {}, {} bytes, {}\n", level, of.size[0], of.size[1], of.size[2],
                        of.bytes,
                        std::isfinite(of.error) ? fmt::format("largest error of a value {:.4g}", of.error)
                                                : "no error bound: some values are not finite numbers");
  }
  return text;
}

void add_convert(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* subcommand = app.add_subcommand(
      "convert", "converts a volume to a compressed file with levels of detail, readable in parts");
  subcommand
      ->add_option("VOLUME", arguments->volume,
                   "volume to convert: raw, NRRD, NIfTI, MetaImage, DICOM, TIFF, VTI or UVOL, a folder of "
                   "slices or of Zarr, or synthetic, as for render")
      ->required();
  subcommand->add_option("-o,--out", arguments->out, "file to write")
      ->required()
      ->type_name("NAME.uvol")
      ->check(can_be_written(".uvol"));
  subcommand
      ->add_option("--max-error", arguments->options.max_error,
                   "largest change of any value of the volume; 0: lossless")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  subcommand
      ->add_option("--prediction", arguments->prediction,
                   "prediction of samples from two neighbours (linear) or from four (cubic)")
      ->check(CLI::IsMember({"linear", "cubic"}))
      ->capture_default_str();
  subcommand
      ->add_option("--effort", arguments->options.effort,
                   "effort of the compression: higher values are slower and produce smaller files")
      ->check(CLI::Range(1, 19))
      ->capture_default_str();
  subcommand
      ->add_option("--time-step", arguments->time_step,
                   "time step to convert, of a file with several, counted from 0")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  add_file_hints(*subcommand, arguments->raw);
  add_progress_options(*subcommand, arguments->progress);
  subcommand->callback([arguments, &chosen] { chosen = [arguments] { return convert(*arguments); }; });
}

}  // namespace understudy::launcher
