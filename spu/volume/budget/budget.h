// SPDX-License-Identifier: Apache-2.0
// One volume's error or time: asked for, chosen for, watched, and reported.
//
//   a new volume, table or service ──► calibrate ──► the cheapest setting that keeps the error, proven on the
//   image itself ──► every frame a few rays are integrated; one that is wrong by more makes the next finer
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "spu/volume/budget/calibration.h"
#include "spu/volume/budget/free_sampling.h"
#include "volume/request.h"

namespace understudy::compositor {
class ImageService;
}

namespace understudy::spu {

struct BudgetCounters;

struct BudgetAsked {
  double error = 0;  ///< greatest difference of a channel from the integral, in (0, 1]; 0: none named
  double ms = 0;     ///< to render and composite an image; 0: none named. An error that is named goes first.
  bool may_halve = false;  ///< nodes send each other floats, which may become half floats

  bool any() const { return error > 0 || ms > 0; }
};

/// Texels around its own that each node holds for the sake of segments of any setting.
constexpr int budget_ghost_layer = 5;

class Budget {
 public:
  explicit Budget(const BudgetAsked& asked) : asked_(asked) {}

  /// The request to render in place of the application's own; empty, with the reason in `counters`, where its
  /// samples must be its own: `obstacle` says so, or the request. May render and integrate on its own account.
  /// Throws as the service does.
  std::optional<volume::RenderRequest> request(compositor::ImageService& service,
                                               const volume::RenderRequest& own, const std::string& obstacle,
                                               const volume::VolumeDescription& volume,
                                               std::uint64_t service_generation, BudgetCounters& counters);

  /// Looks at the image of what request() gave last, which took `ms` if it was cast and not there already.
  /// Takes a fiftieth of the time that passes, and the time of casting where nothing was cast.
  void look_at(compositor::ImageService& service, const volume::ImageView& image, std::optional<double> ms,
               BudgetCounters& counters);

 private:
  using Clock = std::chrono::steady_clock;

  /// What the front was measured for.
  struct MeasuredFor {
    volume::VolumeId volume = 0;
    std::uint64_t version = 0;
    std::uint64_t generation = 0;
    volume::Classification classification;
    bool operator==(const MeasuredFor&) const = default;
  };

  void choose();
  void use(std::size_t of_front);
  void prove(compositor::ImageService& service);
  void try_halves(compositor::ImageService& service);
  Setting setting() const;
  Measured next_finer() const;
  bool go_finer();
  bool keep_ghost_layer(const volume::VolumeDescription& volume);
  void keep_time();
  void tell(BudgetCounters& counters) const;

  const BudgetAsked asked_;
  std::optional<MeasuredFor> measured_for_;
  Calibration calibration_;
  std::size_t chosen_ = 0;                         ///< of the front
  bool as_halves_ = false;                         ///< Setting::as_halves
  std::optional<volume::TransferFunction> table_;  ///< of samples as chosen
  Setting table_for_;
  Meaning meaning_;   ///< of the last request
  double worst_ = 0;  ///< error under the chosen setting: calibrated, or of a ray that was looked at
  std::vector<volume::Pixel> suspects_;  ///< where errors were greatest
  std::size_t spread_ = 0;               ///< pixels of the sequence that were looked at
  std::optional<Clock::time_point> looked_at_;
  double credit_ms_ = 0;  ///< that looking may take
  double ms_a_ray_ = 1;   ///< that it did take
  double ms_ = 0;         ///< of an image, smoothed
  bool times_are_known_ = true;
  int frames_as_chosen_ = 0;
};

}  // namespace understudy::spu
