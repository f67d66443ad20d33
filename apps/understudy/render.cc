#include "apps/understudy/render.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/understudy/backend_option.h"
#include "apps/understudy/environment.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/knots_file.h"
#include "apps/understudy/load_progress.h"
#include "apps/understudy/node_options.h"
#include "apps/understudy/number_list.h"
#include "apps/understudy/own_node_group.h"
#include "apps/understudy/picture.h"
#include "apps/understudy/porter.h"
#include "apps/understudy/render_report.h"
#include "apps/understudy/run.h"
#include "apps/understudy/shading_options.h"
#include "compositor/service/loading_service.h"
#include "compositor/tcp/address.h"
#include "spu/options.h"
#include "volume/file/synthetic.h"
#include "volume/file/volume_file.h"
#include "volume/orbit_camera.h"
#include "volume/raycast/segment_scene.h"
#include "volume/transfer_knots.h"

namespace understudy::launcher {
namespace {

using Clock = std::chrono::steady_clock;
using compositor::LoadingService;
using compositor::RankLoad;

constexpr volume::VolumeId volume_id = 1;
constexpr int max_frames = 10000;
/// Large volumes on busy machines take their time.
constexpr std::chrono::minutes patience{10};

struct RenderArguments {
  std::string volume;
  std::optional<int> nodes;
  std::filesystem::path hostfile;
  std::string connect;  ///< nodes that run already
  LinkPlan link;        ///< if they are on another machine
  NodeChoices choices;
  ShadingArguments shading;
  std::string table = "grey";
  std::string camera = "30,20,4";
  std::string size = "512x512";
  double step = 1;
  int frames = 1;
  double termination = 5e-6;
  std::string out;
  std::string report;
  std::string save_float;
  bool progress = false;
  std::vector<int> volume_size;
  std::string type;
  bool big_endian = false;
  std::vector<double> spacing;
  std::string texels;
  std::string range;
};

volume::FileHints hints_of(const RenderArguments& arguments) {
  volume::FileHints hints;
  if (!arguments.volume_size.empty()) {
    hints.size.emplace();
    std::ranges::copy(arguments.volume_size, hints.size->begin());
  }
  if (!arguments.type.empty()) {
    hints.type = volume::scalar_type_named(arguments.type);
    if (!hints.type)
      throw std::invalid_argument(fmt::format(
          "there is no type '{}'; give u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64", arguments.type));
  }
  if (arguments.big_endian) hints.big_endian = true;
  return hints;
}

volume::TexelChoice texels_of(const RenderArguments& arguments) {
  volume::TexelChoice choice;
  if (arguments.texels == "u8") choice.type = volume::TexelType::u8;
  if (arguments.texels == "u16") choice.type = volume::TexelType::u16;
  if (arguments.texels == "f32") choice.type = volume::TexelType::f32;
  if (!arguments.range.empty()) {
    const std::vector<double> range = numbers(arguments.range, ',', 2, "0,4095");
    choice.range = {range[0], range[1]};
  }
  return choice;
}

/// Everything that can be known to be wrong before a byte of the volume is read.
struct Scene {
  compositor::LoadRequest load;
  volume::FileDescription file;
  volume::TexelMapping mapping;
  volume::TransferKnots knots;
  Shading shading;
  volume::RenderRequest request;  ///< but for the classification, and the surfaces' values
};

Scene scene_of(const RenderArguments& arguments) {
  Scene scene;
  scene.knots = read_knots(arguments.table);
  const std::vector<double> camera = numbers(arguments.camera, ',', 3, "30,20,4", 1);
  const double roll = camera.size() > 3 ? camera[3] : 0;
  const std::vector<double> size = numbers(arguments.size, 'x', 2, "512x512");
  for (const double side : size)
    if (!(side >= 1 && side <= max_picture_side))
      throw std::invalid_argument(
          fmt::format("a picture of {} pixels; give 1 to {} a side", arguments.size, max_picture_side));

  scene.load.file = volume::is_synthetic(arguments.volume)
                        ? arguments.volume
                        : std::filesystem::absolute(arguments.volume).string();
  scene.load.hints = hints_of(arguments);
  scene.load.texels = texels_of(arguments);
  scene.file = volume::open_volume(scene.load.file, scene.load.hints)->description();
  if (!arguments.spacing.empty()) std::ranges::copy(arguments.spacing, scene.file.spacing.begin());
  for (double& distance : scene.file.spacing) distance = volume::believable_spacing(distance);
  scene.mapping = volume::mapping_of(scene.file, scene.load.texels);
  scene.load.volume.id = volume_id;
  scene.load.volume.size = scene.file.size;
  scene.load.volume.type = scene.mapping.type;
  scene.load.volume.stored = {{0, 0, 0}, scene.file.size};
  scene.request =
      volume::orbit_request(scene.load.volume, scene.file.spacing, {camera[0], camera[1], camera[2], roll},
                            int(size[0]), int(size[1]), arguments.step);
  scene.request.termination = float(arguments.termination);

  volume::Vec3 extent{};
  for (std::size_t k = 0; k < 3; ++k) extent[k] = scene.file.size[k] * scene.file.spacing[k];
  scene.shading = shading_of(arguments.shading, extent);
  scene.request.method = scene.shading.method;
  scene.request.tolerance = scene.shading.tolerance;
  scene.request.cut_at_bricks = scene.shading.cut_at_bricks;
  scene.request.op = scene.shading.op;
  scene.request.light = scene.shading.light;
  for (const SurfaceChoice& surface : scene.shading.surfaces)
    scene.request.surfaces.push_back({0, surface.colour});
  // Segments and gradients reach beyond a node's own cells, by no more than the volume has.
  scene.load.volume.margin = volume::margin_needed(scene.load.volume, scene.request);
  if (scene.load.volume.margin > *std::ranges::max_element(scene.file.size))
    throw std::invalid_argument(
        fmt::format("a step of {} voxels is longer than the volume; give a smaller one", arguments.step));
  return scene;
}

/// The table and the surfaces, of normalised texels.
void classify(Scene& scene, const volume::TexelFigures& values, double step) {
  // A volume of one value has no range: the tables' least value is that one.
  const double low = values.low <= values.high ? values.low : 0.0;
  const double high = values.low < values.high ? values.high : low + 1;
  const std::vector<double> surfaces = surface_values(scene.shading, low, high);
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    scene.request.surfaces[i].value = scene.mapping.normalised(surfaces[i]);
  if (scene.request.light) {
    // A thousandth of the values' range per voxel.
    const double range = std::abs(scene.mapping.normalised(high) - scene.mapping.normalised(low));
    scene.request.light->full_slope = float(1e-3 * range / *std::ranges::max_element(scene.file.spacing));
  }
  if (!scene.shading.shows_volume) {
    scene.request.classification = volume::TransferFunction{0, 1, {{}, {}}};
    return;
  }
  const bool segments = scene.request.method == volume::Method::pre_integrated;
  volume::TransferFunction table =
      sampled(segments ? spanning(scene.knots, low, high) : scene.knots, low, high, step);
  table.low = float(scene.mapping.normalised(table.low));
  table.high = float(scene.mapping.normalised(table.high));
  if (table.low > table.high) {  // texels fall where values rise
    std::swap(table.low, table.high);
    std::ranges::reverse(table.entries);
  }
  scene.request.classification = std::move(table);
}

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Over black, or as it is with its alpha.
Picture picture_of(const volume::ImageView& image, const volume::Rect& window, bool with_alpha) {
  Picture picture;
  picture.width = window.width;
  picture.height = window.height;
  picture.has_alpha = with_alpha;
  picture.rgba.assign(4 * window.pixels(), 0.0F);
  for (int y = 0; y < image.rect.height; ++y)
    for (int x = 0; x < image.rect.width; ++x) {
      const float* const from =
          &image.rgba[4 * (std::size_t(y) * std::size_t(image.rect.width) + std::size_t(x))];
      std::copy_n(from, 4, picture.pixel(image.rect.x + x, window.height - 1 - (image.rect.y + y)));
    }
  if (!with_alpha)
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = 1;
  return picture;
}

RenderFigures render_with(LoadingService& service, Scene& scene, const RenderArguments& arguments) {
  RenderFigures figures;
  figures.file = scene.load.file;
  figures.description = scene.file;
  figures.mapping = scene.mapping;
  figures.width = scene.request.window.width;
  figures.height = scene.request.window.height;
  figures.step = arguments.step;
  figures.nodes = service.nodes();

  auto start = Clock::now();
  figures.ranks = service.begin_load(scene.load);
  figures.open_ms = milliseconds_since(start);
  start = Clock::now();
  {
    using Style = LoadProgress::Style;
    LoadProgress progress(arguments.progress             ? Style::lines
                          : ::isatty(STDERR_FILENO) != 0 ? Style::bar
                                                         : Style::silent);
    progress.show(figures.ranks);
    while (!std::ranges::all_of(figures.ranks, &RankLoad::done)) {
      figures.ranks = service.continue_load(volume_id);
      progress.show(figures.ranks);
    }
  }
  figures.load_ms = milliseconds_since(start);

  classify(scene, texel_figures(figures.ranks), arguments.step);
  figures.request = scene.request;
  for (int frame = 0; frame < arguments.frames; ++frame) {
    start = Clock::now();
    const compositor::Rendered rendered = service.render(scene.request);
    figures.frame_ms.push_back(milliseconds_since(start));
    figures.counts = rendered.counts;
    if (frame + 1 < arguments.frames) continue;
    write_png(arguments.out, picture_of(rendered.image, scene.request.window, false));
    if (!arguments.save_float.empty())
      write_pfm(arguments.save_float, picture_of(rendered.image, scene.request.window, true));
  }
  figures.ranks = service.continue_load(volume_id);
  return figures;
}

int render(const RenderArguments& arguments) {
  Placement placement;  // without ranks: in this process
  if (arguments.connect.empty())
    placement = placement_of({arguments.nodes, arguments.hostfile}, current_environment());
  if (placement.ranks == 0 && arguments.choices.backend != "cpu")
    throw std::invalid_argument(
        fmt::format("--backend {} is for nodes of this rendering: give -n N as well, or give it to "
                    "understudy serve",
                    arguments.choices.backend));
  Scene scene = scene_of(arguments);
  RenderFigures figures;
  std::vector<std::string> backends;
  const auto with_linked = [&](const std::string& socket) {
    const std::unique_ptr<LoadingService> service =
        compositor::linked_loading_service(socket, {patience, patience, patience, patience, patience});
    figures = render_with(*service, scene, arguments);
  };
  try {
    if (compositor::tcp_address_of(arguments.connect))
      with_link(arguments.link, arguments.connect, arguments.choices.pixels, with_linked);
    else if (!arguments.connect.empty())
      with_linked(arguments.connect);
    else if (placement.ranks > 0)
      backends = with_own_nodes({placement, arguments.choices}, with_linked);
    else
      figures = render_with(*compositor::embedded_loading_service(), scene, arguments);
  } catch (const compositor::ServiceLost& lost) {
    throw std::runtime_error(
        fmt::format("no picture was made: render again, or in this process, without nodes ({})", lost.what()));
  }
  figures.backends = backends;
  for (const std::string& choice : backends) fmt::print(stderr, "understudy: {}\n", choice);
  if (!arguments.report.empty()) write_render_report(arguments.report, figures);
  std::fputs(summary_text(figures).c_str(), stdout);
  return 0;
}

}  // namespace

void add_render(CLI::App& app, std::function<int()>& chosen) {
  const auto arguments = std::make_shared<RenderArguments>();
  CLI::App* render_command = app.add_subcommand("render", "a picture of a volume in a file, without a viewer");
  render_command
      ->add_option("VOLUME", arguments->volume,
                   "raw (size and type in its name: head_256x256x113_int16be.raw.gz), NRRD, NIfTI or VTI, or "
                   "synthetic:XxYxZ[:u8|u16|f32[:shells|lobes|gyroid]]")
      ->required();
  CLI::Option* nodes =
      render_command
          ->add_option("-n,--nodes", arguments->nodes,
                       "MPI ranks, each reads its own part; without, and without a hostfile or a Slurm "
                       "allocation: this process")
          ->check(CLI::Range(1, spu::max_nodes));
  add_hostfile_option(*render_command, arguments->hostfile);
  render_command
      ->add_option("--connect", arguments->connect,
                   "nodes that `understudy serve` keeps: a socket, or HOST:PORT")
      ->type_name("WHERE")
      ->excludes(nodes)
      ->excludes(render_command->get_option("--hostfile"));
  add_link_options(*render_command, arguments->link);
  add_backend_option(*render_command, arguments->choices.backend);
  add_gpu_memory_option(*render_command, arguments->choices.gpu_memory);
  add_exchange_options(*render_command, arguments->choices);
  render_command->add_option("--out", arguments->out, "the picture, over black")
      ->type_name("P.png")
      ->required();
  render_command
      ->add_option("--save-float", arguments->save_float, "the picture before it is rounded, and its alpha")
      ->type_name("F.pfm");
  render_command->add_option("--report", arguments->report, "figures as JSON")->type_name("F.json");
  render_command
      ->add_option("--table", arguments->table,
                   "transfer function: a JSON file of knots, or one of " + volume::built_in_knots())
      ->capture_default_str();
  add_shading_options(*render_command, arguments->shading);
  render_command
      ->add_option("--camera", arguments->camera,
                   "azimuth and elevation in degrees, distance in half diagonals, and degrees by which it "
                   "rolls (180: z is down)")
      ->type_name("A,E,D[,R]")
      ->capture_default_str();
  render_command->add_option("--size", arguments->size, "of the picture")
      ->type_name("WxH")
      ->capture_default_str();
  render_command->add_option("--step", arguments->step, "between samples, in voxels")->capture_default_str();
  render_command
      ->add_option("--termination", arguments->termination, "a ray ends where less than this shows through")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  render_command->add_option("--frames", arguments->frames, "render as often, for the time")
      ->check(CLI::Range(1, max_frames))
      ->capture_default_str();
  render_command->add_flag("--progress", arguments->progress,
                           "loading as lines, with the bytes read by each rank");
  render_command->add_option("--volume-size", arguments->volume_size, "of raw scalars")
      ->type_name("X Y Z")
      ->expected(3);
  render_command->add_option("--type", arguments->type, "of raw scalars: u8, i8, … f64");
  render_command->add_flag("--big-endian", arguments->big_endian, "of raw scalars");
  render_command->add_option("--spacing", arguments->spacing, "between scalars, instead of the file's")
      ->type_name("X Y Z")
      ->expected(3)
      ->check(CLI::PositiveNumber);
  render_command->add_option("--texels", arguments->texels, "what is kept of each scalar")
      ->check(CLI::IsMember({"u8", "u16", "f32"}));
  render_command->add_option("--range", arguments->range, "values that the texels of u8 and u16 span")
      ->type_name("LOW,HIGH");
  render_command->callback([arguments, &chosen] { chosen = [arguments] { return render(*arguments); }; });
}

}  // namespace understudy::launcher
