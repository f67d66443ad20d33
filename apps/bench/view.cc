// SPDX-License-Identifier: Apache-2.0
// A client without a display that turns a volume: measures the time from user input to the image.
// Prints JSON lines for view.py.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/understudy/view/web_client.h"

namespace {

using understudy::launcher::WebClient;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

double at_share(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[std::min(values.size() - 1, std::size_t(share * double(values.size())))];
}

/// One kind of image: what is requested in addition to a small rotation of the camera.
struct Way {
  const char* name;
  Json request;
  bool tells_time;  ///< report the time, as a page does, so that slow images become smaller
};

void measure(WebClient& client, const Way& way, int images) {
  constexpr int warming = 10;
  std::vector<double> all_ms;
  double bytes = 0, cast_ms = 0, pack_ms = 0, pixels = 0;
  Json request = way.request;
  for (int i = 0; i < images + warming; ++i) {
    request["rotate"] = {{0, 0}, {0.02, 0.005}};
    const Clock::time_point start = Clock::now();
    const WebClient::Message message = client.image(request);
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (way.tells_time) request["took_ms"] = ms;
    if (i < warming) continue;
    all_ms.push_back(ms);
    bytes += double(message.image.size());
    cast_ms += double(message.json.at("ms").at("image"));
    pack_ms += double(message.json.at("ms").at("pack"));
    pixels += double(message.json.at("width")) * double(message.json.at("height"));
  }
  std::puts(Json{{"way", way.name},
                 {"median_ms", at_share(all_ms, 0.5)},
                 {"late_ms", at_share(all_ms, 0.95)},
                 {"cast_ms", cast_ms / images},
                 {"pack_ms", pack_ms / images},
                 {"bytes", bytes / images},
                 {"pixels", pixels / images}}
                .dump()
                .c_str());
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{
      "Rotates a volume that `understudy view --web` shows, and measures the time from request to image."};
  app.set_help_flag("-h,--help", "print this help and exit");
  int port = 0, images = 100, rounds = 3;
  std::string secret;
  app.add_option("PORT", port, "port of `understudy view --web`")->required();
  app.add_option("SECRET", secret, "secret in the link that `understudy view` prints")->required();
  app.add_option("--images", images, "number of images of each kind in each round")
      ->check(CLI::Range(1, 10000));
  app.add_option("--rounds", rounds, "number of rounds")->check(CLI::Range(1, 100));
  CLI11_PARSE(app, argc, argv);
  WebClient client(port);
  client.greet(secret);
  client.wait_for("volume");
  for (int round = 0; round < rounds; ++round)
    for (const Way& way : {Way{"jpeg", {{"still", false}, {"took_ms", 0}}, false},
                           Way{"lossless", {{"still", true}}, false}, Way{"moving", {{"still", false}}, true}})
      measure(client, way, images);
} catch (const std::exception& error) {
  std::fprintf(stderr, "understudy-bench-view: %s\n", error.what());
  return 1;
}
