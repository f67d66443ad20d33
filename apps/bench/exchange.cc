// SPDX-License-Identifier: Apache-2.0
// understudy-bench-exchange: composites partial images into one image on rank 0, with each of our
// exchanges and, if the build found it, with IceT. Runs as one rank of an MPI job. All methods get the
// same images in turn; the time is that of the slowest rank, from a barrier to completion. Rank 0
// prints one JSON object a line.
#include "compositor/exchange/exchange.h"

#include <fmt/format.h>
#include <mpi.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "apps/bench/message_counter.h"
#include "apps/bench/partial_images.h"
#include "compositor/exchange/cost.h"
#include "compositor/exchange/measure_message_cost.h"
#include "compositor/exchange/mpi_communicator.h"
#ifdef UNDERSTUDY_ICET
#include "apps/bench/icet_compositor.h"
#include "volume/blending_operator.h"
#include "volume/image.h"
#endif

namespace {

using namespace understudy;
using compositor::Communicator;
using volume::Image;
using volume::ImageView;
using volume::Rect;

struct Settings {
  std::string file;
  int side = 256;
  std::vector<int> pixels{512, 1024};
  int rounds = 15;
  std::vector<std::string> only;  ///< names of the ways to time; empty: all
};

/// One compositing method. All ranks call both functions; the time of prepare() is not measured.
struct Way {
  std::string name;
  std::function<void(const Image& mine)> prepare;
  std::function<void()> compose;
  std::function<ImageView()> image;  ///< result of the last compose(), on rank 0
  std::vector<double> seconds{};
  bench::Sent sent{};  ///< by all ranks, in one compose()
  double error = 0;    ///< largest error of any component in the last image
};

/// Composites all images front to back, in double precision.
std::vector<double> product_of(const std::vector<Image>& images, std::span<const int> order, int pixels) {
  std::vector<double> product(4 * std::size_t(pixels) * std::size_t(pixels), 0.0);
  for (const int rank : order) {
    const Image& image = images[std::size_t(rank)];
    for (int y = image.rect.y; y < image.rect.y + image.rect.height; ++y)
      for (int x = image.rect.x; x < image.rect.x + image.rect.width; ++x) {
        double* const sum = &product[4 * (std::size_t(y) * std::size_t(pixels) + std::size_t(x))];
        const double clear = 1 - sum[3];
        const float* const behind = image.at(x, y);
        for (std::size_t c = 0; c < 4; ++c) sum[c] += clear * double(behind[c]);
      }
  }
  return product;
}

/// Pixels outside of the image count as clear.
double largest_error(const ImageView& image, std::span<const double> product, int pixels) {
  double largest = 0;
  for (int y = 0; y < pixels; ++y)
    for (int x = 0; x < pixels; ++x) {
      const Rect& rect = image.rect;
      const bool inside = !intersection(rect, {x, y, 1, 1}).empty();
      for (std::size_t c = 0; c < 4; ++c) {
        const double exact = product[4 * (std::size_t(y) * std::size_t(pixels) + std::size_t(x)) + c];
        const double shown = inside ? double(image.rgba[4 * (std::size_t(y - rect.y) * std::size_t(rect.width) +
                                                             std::size_t(x - rect.x)) +
                                                        c])
                                    : 0;
        largest = std::max(largest, std::abs(shown - exact));
      }
    }
  return largest;
}

/// Returns the images of all ranks on rank 0, and an empty vector elsewhere.
std::vector<Image> gathered(const Image& mine, std::span<const Rect> footprints, Communicator& communicator) {
  std::vector<Image> images;
  if (communicator.rank() != 0) {
    const compositor::Outgoing out{0, std::as_bytes(std::span(mine.rgba))};
    if (!mine.rgba.empty()) communicator.transfer({&out, 1}, {});
    return images;
  }
  std::vector<compositor::Incoming> incoming;
  for (const Rect& footprint : footprints) images.emplace_back(footprint);
  images[0] = mine;
  for (std::size_t rank = 1; rank < images.size(); ++rank)
    if (!images[rank].rgba.empty())
      incoming.push_back({int(rank), std::as_writable_bytes(std::span(images[rank].rgba)), nullptr});
  communicator.transfer({}, incoming);
  return images;
}

std::vector<Rect> footprints_of(Rect mine, Communicator& communicator) {
  std::vector<Rect> footprints(std::size_t(communicator.size()));
  communicator.gather_to_all(compositor::bytes_of(mine), std::as_writable_bytes(std::span(footprints)));
  return footprints;
}

/// Makes the ranks communicate as if each had its own machine: no message is read in place.
class Apart final : public Communicator {
 public:
  explicit Apart(Communicator& communicator) : communicator_(communicator) {}
  compositor::Rank rank() const override { return communicator_.rank(); }
  int size() const override { return communicator_.size(); }
  void transfer(std::span<const compositor::Outgoing> outgoing,
                std::span<const compositor::Incoming> incoming) override {
    std::vector<compositor::Outgoing> sent(outgoing.begin(), outgoing.end());
    std::vector<compositor::Incoming> come(incoming.begin(), incoming.end());
    for (compositor::Outgoing& message : sent) message.may_be_seen = false;
    for (compositor::Incoming& message : come) message.seen = nullptr;
    communicator_.transfer(sent, come);
  }
  void broadcast(compositor::Rank root, std::span<std::byte> bytes) override {
    communicator_.broadcast(root, bytes);
  }
  void gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) override {
    communicator_.gather_to_all(mine, all);
  }
  void send_control(compositor::Rank to, std::span<const std::byte> control) override {
    communicator_.send_control(to, control);
  }
  std::optional<compositor::ControlMessage> take_control_message() override {
    return communicator_.take_control_message();
  }
  compositor::ControlMessage wait_for_control_message() override {
    return communicator_.wait_for_control_message();
  }
  [[noreturn]] void abandon(const std::string& why) override {
    communicator_.abandon(why);
    throw compositor::RankLost(
        why);  // never reached, but gcc does not rely on [[noreturn]] of a virtual function
  }

 private:
  Communicator& communicator_;
};

/// Our exchanges, called as a node calls them: the ranks first agree on the footprints.
class Ours {
 public:
  Ours(Communicator& communicator, compositor::MessageCost cost) : communicator_(communicator), cost_(cost) {}

  Way way(std::string name, std::optional<compositor::Algorithm> algorithm, compositor::Layout layout,
          const std::vector<int>& order, bool packed = true) {
    return {.name = std::move(name),
            .prepare = [this](const Image& mine) { image_ = mine; },
            .compose =
                [this, algorithm, layout, packed, &order] {
                  const std::vector<Rect> footprints = footprints_of(image_.rect, communicator_);
                  compositor::Schedule plan = algorithm ? schedule(*algorithm, order, footprints)
                                                        : cheapest(order, footprints, layout, cost_);
                  plan.packed = packed;
                  composited_ = compositor::exchange(std::move(image_), plan, volume::Operator::over, layout,
                                                     communicator_)
                                    .image;
                },
            .image = [this] { return composited_.view(); }};
  }

 private:
  Communicator& communicator_;
  compositor::MessageCost cost_;
  Image image_, composited_;
};

double slowest(double seconds) {
  double result = 0;
  MPI_Reduce(&seconds, &result, 1, MPI_DOUBLE, MPI_MAX, 0, MPI_COMM_WORLD);
  return result;
}

bench::Sent by_all(const bench::Sent& mine) {
  std::array<std::uint64_t, 2> part{mine.messages, mine.bytes}, all{};
  MPI_Reduce(part.data(), all.data(), 2, MPI_UINT64_T, MPI_SUM, 0, MPI_COMM_WORLD);
  return {all[0], all[1]};
}

void measure(std::vector<Way>& ways, const Image& mine, int rounds) {
  // In the first two rounds, libraries allocate their buffers.
  constexpr int settle = 2;
  for (int round = 0; round < settle + rounds; ++round)
    for (std::size_t i = 0; i < ways.size(); ++i) {
      Way& way = ways[(i + std::size_t(round)) % ways.size()];
      way.prepare(mine);
      MPI_Barrier(MPI_COMM_WORLD);
      bench::take_sent();
      const double start = MPI_Wtime();
      way.compose();
      const double seconds = slowest(MPI_Wtime() - start);
      way.sent = by_all(bench::take_sent());
      if (round >= settle) way.seconds.push_back(seconds);
    }
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

std::vector<std::byte> read(const std::string& file, std::size_t count) {
  std::vector<std::byte> bytes(count);
  std::ifstream in(file, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(count)))
    throw std::runtime_error(fmt::format("{} does not contain {} bytes", file, count));
  return bytes;
}

/// Every exchange, and the one with the lowest estimated cost ("auto").
std::vector<Way> our_ways(Ours& apart, Ours& on_one_machine, const bench::PartialImage& mine) {
  using compositor::Layout;
  std::vector<Way> ways;
  for (std::size_t a = 0; a < compositor::algorithm_count; ++a)
    ways.push_back(apart.way(std::string(name_of(compositor::Algorithm(a))), compositor::Algorithm(a),
                             Layout::rgba32f, mine.order));
  ways.push_back(apart.way("auto", {}, Layout::rgba32f, mine.order));
  ways.push_back(apart.way("auto, unpacked", {}, Layout::rgba32f, mine.order, false));
  // As on nodes whose ranks are all on one machine.
  for (std::size_t a = 0; a < compositor::algorithm_count; ++a)
    ways.push_back(on_one_machine.way(fmt::format("{}, in place", name_of(compositor::Algorithm(a))),
                                      compositor::Algorithm(a), Layout::rgba32f, mine.order, false));
  ways.push_back(on_one_machine.way("auto, in place", {}, Layout::rgba32f, mine.order, false));
  ways.push_back(apart.way("auto, half", {}, Layout::rgba16f, mine.order));
  ways.push_back(apart.way("auto, byte", {}, Layout::rgba8, mine.order));
  return ways;
}

/// Fills the errors of `ways`, on rank 0.
void judge(std::vector<Way>& ways, const bench::PartialImage& mine, std::span<const Rect> footprints,
           int pixels, Communicator& communicator) {
  const std::vector<Image> images = gathered(mine.image, footprints, communicator);
  std::vector<double> product;
  if (communicator.rank() == 0) product = product_of(images, mine.order, pixels);
  for (Way& way : ways) {
    way.prepare(mine.image);
    way.compose();
    if (communicator.rank() == 0) way.error = largest_error(way.image(), product, pixels);
  }
}

void print(const Way& way, int ranks, bench::Scene scene, int pixels, std::size_t covered) {
  fmt::print("{}\n", nlohmann::ordered_json{{"ranks", ranks},
                                            {"scene", name_of(scene)},
                                            {"pixels", pixels},
                                            {"covered", covered},
                                            {"way", way.name},
                                            {"ms", 1e3 * median(way.seconds)},
                                            {"least_ms", 1e3 * *std::ranges::min_element(way.seconds)},
                                            {"bytes", way.sent.bytes},
                                            {"messages", way.sent.messages},
                                            {"error", way.error}}
                         .dump());
}

void run(const Settings& settings, Communicator& communicator) {
  const auto side = std::size_t(settings.side);
  const std::vector<std::byte> texels = read(settings.file, side * side * side);
  Apart apart(communicator);
  const compositor::MessageCost cost = measure_message_cost(communicator);
  Ours ours(apart, cost), on_one_machine(communicator, cost);
#ifdef UNDERSTUDY_ICET
  bench::IcetCompositor icet;
#endif
  for (const int pixels : settings.pixels)
    for (const bench::Scene scene : bench::all_scenes) {
      const bench::PartialImage mine =
          partial_image(scene, pixels, texels, settings.side, communicator.rank(), communicator.size());
      std::vector<Way> ways = our_ways(ours, on_one_machine, mine);
#ifdef UNDERSTUDY_ICET
      icet.begin(pixels, mine.order);
      ImageView shown;
      for (const std::string& strategy : bench::IcetCompositor::strategies())
        ways.push_back({.name = "icet/" + strategy,
                        .prepare = [&](const Image& image) { icet.lay_in(image); },
                        .compose = [&icet, &shown, strategy] { shown = icet.compose(strategy); },
                        .image = [&] { return shown; }});
#endif
      if (!settings.only.empty())
        std::erase_if(ways, [&](const Way& way) { return std::ranges::count(settings.only, way.name) == 0; });
      const std::vector<Rect> footprints = footprints_of(mine.image.rect, communicator);
      judge(ways, mine, footprints, pixels, communicator);
      measure(ways, mine.image, settings.rounds);
      if (communicator.rank() != 0) continue;
      std::size_t covered = 0;
      for (const Rect& footprint : footprints) covered += footprint.pixels();
      for (const Way& way : ways) print(way, communicator.size(), scene, pixels, covered);
      std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Times exchanges of partial images, by Understudy and by IceT. Runs as one rank of an MPI job."};
  app.set_help_flag("-h,--help", "print this help and exit");
  app.add_option("volume", settings.file, "volume file: raw bytes, x fastest")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--side", settings.side, "number of voxels along each axis")->check(CLI::Range(8, 1024));
  app.add_option("--pixels", settings.pixels, "edges of the images, in pixels")
      ->delimiter(',')
      ->check(CLI::Range(1, 8192));
  app.add_option("--rounds", settings.rounds, "number of rounds, of which the median counts")
      ->check(CLI::Range(1, 10000));
  app.add_option("--only", settings.only, "time only these methods, named as in the output");
  CLI11_PARSE(app, argc, argv);
  compositor::MpiCommunicator communicator(argc, argv);
  try {
    run(settings, communicator);
  } catch (const std::exception& error) {
    communicator.abandon(error.what());
  }
}
