// SPDX-License-Identifier: Apache-2.0
// understudy-bench-hierarchy: measures how fast hierarchical volumes are written and read, on one core
// and on all, and their size compared with Zstandard's own compression of the same scalars. Prints one
// JSON object for each turn.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>
#include <zstd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "volume/file/hierarchical_writer.h"
#include "volume/file/volume_file.h"
#include "volume/opening/open_volume.h"

namespace {

using namespace understudy::volume;
using Clock = std::chrono::steady_clock;

/// Bytes that are read at once, as on the nodes.
constexpr std::size_t part_bytes = std::size_t(16) << 20;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<std::byte> all_scalars(VolumeFile& volume) {
  const TexelBox box{{0, 0, 0}, volume.description().size};
  std::vector<std::byte> scalars(texels_in(box) * bytes_per_scalar(volume.description().type));
  volume.read(box, scalars);
  return scalars;
}

/// Reads all slices in order; returns the seconds that this takes.
double time_to_read(const std::string& path) {
  const auto start = Clock::now();
  const auto volume = open_volume(path);
  const auto& size = volume->description().size;
  const std::size_t slice =
      std::size_t(size[0]) * std::size_t(size[1]) * bytes_per_scalar(volume->description().type);
  const int at_once = std::max(1, int(part_bytes / slice));
  std::vector<std::byte> scalars;
  for (int z = 0; z < size[2]; z += at_once) {
    const TexelBox box{{0, 0, z}, {size[0], size[1], std::min(z + at_once, size[2])}};
    scalars.resize(slice * std::size_t(box.high[2] - z));
    volume->read(box, scalars);
  }
  return seconds_since(start);
}

std::size_t zstd_bytes(const std::vector<std::byte>& scalars, int level) {
  std::vector<std::byte> packed(ZSTD_compressBound(scalars.size()));
  return ZSTD_compress(packed.data(), packed.size(), scalars.data(), scalars.size(), level);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Times writing and reading hierarchical volumes."};
  app.set_help_flag("-h,--help", "print this help and exit");
  std::string name;
  double max_error = 0;
  int turns = 3;
  bool packs = false;
  app.add_option("VOLUME", name, "volume file")->required();
  app.add_option("--max-error", max_error, "largest change of any value of the volume; 0: lossless");
  app.add_option("--turns", turns, "number of turns");
  app.add_flag("--zstd", packs,
               "also measure the size of the scalars when compressed by Zstandard at levels 3 and 19");
  CLI11_PARSE(app, argc, argv);

  // Write the scalars to an uncompressed file first, so that reading a compressed original is not timed.
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("understudy-bench-hierarchy-{}", ::getpid());
  std::filesystem::create_directory(folder);
  const auto original = open_volume(name);
  const std::vector<std::byte> scalars = all_scalars(*original);
  const FileDescription& description = original->description();
  const std::string raw = folder / fmt::format("v_{}x{}x{}_{}.raw", description.size[0], description.size[1],
                                               description.size[2], name_of(description.type));
  if (std::FILE* file = std::fopen(raw.c_str(), "wb")) {
    std::fwrite(scalars.data(), 1, scalars.size(), file);
    std::fclose(file);
  }
  const std::string path = folder / "v.uvol";
  const auto all_cores = int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  for (int turn = 0; turn < turns; ++turn)
    for (const int cores : {1, all_cores}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(cores));
      const auto volume = open_volume(raw);
      const auto start = Clock::now();
      const HierarchyFigures figures = write_hierarchical(*volume, path, {.max_error = max_error});
      const double building = seconds_since(start);
      const double reading = time_to_read(path);
      const double bytes = double(scalars.size());
      const nlohmann::json row{{"turn", turn},
                               {"cores", cores},
                               {"build_bytes_per_second", bytes / building},
                               {"read_bytes_per_second", bytes / reading},
                               {"part_of_scalars", double(figures.file_bytes) / bytes}};
      fmt::print("{}\n", row.dump());
      std::fflush(stdout);
    }
  if (packs)
    for (const int level : {3, 19})
      fmt::print("{}\n", nlohmann::json{{"zstd", level},
                                        {"part_of_scalars",
                                         double(zstd_bytes(scalars, level)) / double(scalars.size())}}
                             .dump());
  std::filesystem::remove_all(folder);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "understudy-bench-hierarchy: {}\n", error.what());
  return 1;
}
