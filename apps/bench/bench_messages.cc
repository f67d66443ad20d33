// SPDX-License-Identifier: Apache-2.0
// understudy-bench-messages: measures the costs of messages, bytes and pixels between the ranks of this MPI
// job, and prints them as one JSON object. Started by mpirun.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "compositor/exchange/measure_message_cost.h"
#include "compositor/exchange/mpi_communicator.h"
#include "compositor/exchange/pixel_layout.h"
#include "volume/blending_operator.h"
#include "volume/image.h"

namespace {

using namespace understudy;

constexpr int repetitions = 12;

template <class Work>
double shortest(const Work& work) {
  double least = std::numeric_limits<double>::max();
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

/// The middle two thirds of each row are covered, as in the image of a box.
volume::Image some_image() {
  constexpr int edge = 384, from = edge / 6, to = edge - from;
  volume::Image image({0, 0, edge, edge});
  for (int y = 0; y < edge; ++y) std::fill(image.at(from, y), image.at(to, y), 0.5F);
  return image;
}

}  // namespace

int main(int argc, char** argv) {
  compositor::MpiCommunicator communicator(argc, argv);
  const auto of_a_megabyte = [](const compositor::MessageCost& cost) {
    return cost.latency + 1e6 * cost.per_byte;
  };
  compositor::MessageCost least = compositor::measure_message_cost(communicator);
  for (int i = 1; i < repetitions; ++i)
    if (const compositor::MessageCost again = compositor::measure_message_cost(communicator);
        of_a_megabyte(again) < of_a_megabyte(least))
      least = again;
  if (communicator.rank() != 0) return 0;

  using namespace compositor;
  const volume::Image image = some_image();
  PixelMessage message;
  const double pack = shortest(
      [&] { message = encode_pixels(image, image.rect, volume::Operator::over, Layout::rgba32f, false); });
  PixelMessage arrived = space_for_pixels(image.rect, Layout::rgba32f);
  std::ranges::copy(message.bytes(), arrived.room().begin());
  arrived.received() = message.size();
  volume::Image unpacked(image.rect);
  const double unpack = shortest([&] {
    PixelReader reader(arrived, image.rect, Layout::rgba32f);
    for (int y = 0; y < image.rect.height; ++y)
      reader.read_row({unpacked.at(image.rect.x, y), 4 * std::size_t(image.rect.width)});
  });
  std::vector<float> written(image.rgba.size());
  const double write = shortest([&] { std::ranges::copy(image.rgba, written.begin()); });
  const nlohmann::ordered_json row{{"latency", least.latency},
                                   {"per_byte", least.per_byte},
                                   {"per_pixel_blended", least.per_pixel},
                                   {"ranks_at_once", least.ranks_at_once},
                                   {"per_byte_packed", pack / double(message.size())},
                                   {"per_byte_unpacked", unpack / double(message.size())},
                                   {"per_pixel_written", write / double(image.rect.pixels())}};
  fmt::print("{}\n", row.dump());
}
