// SPDX-License-Identifier: Apache-2.0
// understudy-bench-shares: counts the images that a client of `understudy serve` gets in a second, in turn:
// alone, beside a client whose requests exceed the limit and are refused, and beside a client that requests as
// much as the limit allows. Both neighbours send the next request as soon as the last one is answered. Prints
// one JSON object for each turn.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "compositor/rendered.h"
#include "compositor/service/limits.h"
#include "compositor/service/loading_service.h"
#include "compositor/service/remote_service.h"
#include "volume/request.h"

namespace {

using namespace understudy;
using namespace understudy::compositor;

constexpr int volume_side = 64;
constexpr volume::VolumeId the_volume = 7;

/// Returns a client that has loaded its volume.
std::unique_ptr<LoadingService> client_of(const std::string& socket) {
  // On a busy machine, a neighbour's image takes longer than the default limit; it must not
  // be disconnected for that.
  Patience patience;
  patience.render = std::chrono::minutes(2);
  auto service = remote_loading_service(socket, patience);
  LoadRequest load;
  load.volume.id = the_volume;
  load.volume.size = {volume_side, volume_side, volume_side};
  load.volume.stored = {{0, 0, 0}, load.volume.size};
  load.file = fmt::format("synthetic:{0}x{0}x{0}", volume_side);
  service->begin_load(load);
  while (!std::ranges::all_of(service->continue_load(the_volume), &RankLoad::done)) continue;
  return service;
}

/// A request of side^2 pixels with `samples` samples each: the opacity terminates no ray, and nothing is empty.
volume::RenderRequest request_of(int side, int samples) {
  volume::RenderRequest request;
  request.volume = the_volume;
  request.texture_to_clip = {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, -1, 0, 0, 0, 1};
  request.viewport = request.window = {0, 0, side, side};
  request.planes = {{0, 0, 1}, 0.5 / samples, 1.0 / samples, samples};
  volume::TransferFunction function;
  function.low = 0;
  function.high = 1;
  function.entries.assign(256, {0.5F, 0.5F, 0.5F, 1e-6F});
  request.classification = function;
  return request;
}

/// Moves the view slightly with each request, so that no image can be reused and each is cast.
volume::RenderRequest moved(volume::RenderRequest request, int number) {
  request.texture_to_clip[3] += 1e-3 * (number % 97);
  return request;
}

struct Answers {
  int images = 0;
  int refusals = 0;
};

void ask(RenderService& service, const volume::RenderRequest& request, int number, Answers& answers) {
  try {
    service.render(moved(request, number));
    ++answers.images;
  } catch (const RequestRefused&) {
    ++answers.refusals;
  }
}

/// A client on its own thread, which sends requests until leave() is called.
class Neighbour {
 public:
  Neighbour(const std::string& socket, const volume::RenderRequest& request)
      : thread_([this, socket, request](const std::stop_token& stop) {
          try {
            const auto service = client_of(socket);
            begin_to_ask();
            for (int number = 0; !stop.stop_requested(); ++number) ask(*service, request, number, answers_);
          } catch (...) {
            failure_ = std::current_exception();
            begin_to_ask();
          }
        }) {}

  void wait_until_it_asks() const { asks_.wait(false); }

  /// Waits for the last answer. Rethrows the exception that ended the thread early, if any.
  Answers leave() {
    thread_.request_stop();
    thread_.join();
    if (failure_) std::rethrow_exception(failure_);
    return answers_;
  }

 private:
  void begin_to_ask() {
    asks_ = true;
    asks_.notify_all();
  }

  std::atomic<bool> asks_ = false;
  Answers answers_;
  std::exception_ptr failure_;
  std::jthread thread_;  // last member, because it uses the others
};

struct Beside {
  const char* name;
  std::optional<volume::RenderRequest> request;  ///< empty: there is no neighbour
  double seconds;
};

nlohmann::json turn(const std::string& socket, const char* size, const volume::RenderRequest& own,
                    const Beside& beside) {
  const auto service = client_of(socket);
  std::optional<Neighbour> neighbour;
  if (beside.request) {
    neighbour.emplace(socket, *beside.request);
    neighbour->wait_until_it_asks();
  }
  Answers mine;
  ask(*service, own, 0, mine);  // the first image includes one-time preparation
  mine = {};
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const auto end = begin + std::chrono::duration<double>(beside.seconds);
  for (int number = 1; Clock::now() < end; ++number) ask(*service, own, number, mine);
  const double took = std::chrono::duration<double>(Clock::now() - begin).count();
  const Answers others = neighbour ? neighbour->leave() : Answers{};
  return {{"size", size},
          {"beside", beside.name},
          {"seconds", took},
          {"images", mine.images},
          {"refused", mine.refusals},
          {"images_of_neighbour", others.images},
          {"refused_to_neighbour", others.refusals}};
}

}  // namespace

int main(int argc, char** argv) {
  std::string socket;
  int rounds = 3;
  double seconds = 10;
  double seconds_of_attack = 60;
  CLI::App app("Measures how many images a client gets from nodes that other clients load heavily.");
  app.set_help_flag("-h,--help", "print this help and exit");
  app.add_option("--socket", socket, "socket of `understudy serve`")->required();
  app.add_option("--rounds", rounds, "number of rounds; each runs all turns one after another")
      ->capture_default_str();
  app.add_option("--seconds", seconds, "duration of turns alone and beside refused requests, in seconds")
      ->capture_default_str();
  app.add_option("--seconds-of-attack", seconds_of_attack,
                 "duration of turns beside a client that requests as much as it may, in seconds")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  // 8192^2 pixels of 2^22 samples each are 128 times the limit of one image, and refused at once. The other
  // request is half of the limit, and is cast for as long as an image may take.
  const volume::RenderRequest excessive = request_of(8192, 1 << 22);
  const volume::RenderRequest endless = request_of(2048, 1 << 18);
  static_assert((std::uint64_t(8192) * 8192 << 22) / limits::max_image_samples == 128);
  static_assert((std::uint64_t(2048) * 2048 << 18) * 2 == limits::max_image_samples);
  // Requests below and above limits::short_request are scheduled differently.
  const std::array<std::pair<const char*, volume::RenderRequest>, 2> sizes = {
      {{"small", request_of(128, 64)}, {"large", request_of(512, 512)}}};
  const std::array<Beside, 3> besides = {{{"nobody", std::nullopt, seconds},
                                          {"refused requests", excessive, seconds},
                                          {"endless requests", endless, seconds_of_attack}}};
  try {
    for (int round = 0; round < rounds; ++round)
      for (const auto& [size, own] : sizes)
        for (const Beside& beside : besides) {
          fmt::print("{}\n", turn(socket, size, own, beside).dump());
          std::fflush(stdout);
        }
  } catch (const std::exception& error) {
    fmt::print(stderr, "understudy-bench-shares: {}\n", error.what());
    return 1;
  }
}
