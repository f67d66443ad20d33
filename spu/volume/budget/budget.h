// SPDX-License-Identifier: Apache-2.0
// The error or time budget of one volume: chooses a setting for it, checks images, and reports both.
//
//   a new volume, transfer function or service --> calibrate --> the cheapest setting within the error, proven
//   on the image itself --> each frame integrates a few rays; an error above the limit makes it finer
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
  double error = 0;        ///< greatest difference of a channel from the integral, in (0, 1]; 0: no limit
  double ms = 0;           ///< to render and composite an image; 0: no limit. An error limit takes precedence.
  bool may_halve = false;  ///< nodes exchange floats, which may become half floats

  bool any() const { return error > 0 || ms > 0; }
  bool operator==(const BudgetAsked&) const = default;
};

/// Width in texels of the ghost layer that each node holds, so that segments of other settings fit.
constexpr int budget_ghost_layer = 5;

class Budget {
 public:
  explicit Budget(const BudgetAsked& asked) : asked_(asked) {}

  const BudgetAsked& asked() const { return asked_; }

  /// Returns the request to render in place of `own`. Empty, with the reason in `counters`, if the samples must
  /// stay the application's own because of `obstacle` or of the request itself. May render and integrate in
  /// order to calibrate. Throws as the service does.
  std::optional<volume::RenderRequest> request(compositor::ImageService& service,
                                               const volume::RenderRequest& own, const std::string& obstacle,
                                               const volume::VolumeDescription& volume,
                                               std::uint64_t service_generation, BudgetCounters& counters);

  /// Checks the image of the last request(), which took `ms` to cast; empty if it was reused instead. Checks
  /// take a fiftieth of the elapsed time, and for a reused image also the time that casting would have taken.
  void look_at(compositor::ImageService& service, const volume::ImageView& image, std::optional<double> ms,
               BudgetCounters& counters);

 private:
  using Clock = std::chrono::steady_clock;

  /// The front is measured anew when this changes.
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
  std::size_t chosen_ = 0;                         ///< index in the front
  bool as_halves_ = false;                         ///< Setting::as_halves
  std::optional<volume::TransferFunction> table_;  ///< transfer function for table_for_
  Setting table_for_;
  Meaning meaning_;   ///< of the last request
  double worst_ = 0;  ///< error of the chosen setting: calibrated, or of a ray that was checked
  std::vector<volume::Pixel> suspects_;  ///< pixels where a finer setting differed most
  std::size_t spread_ = 0;               ///< pixels of the sequence that were checked
  std::optional<Clock::time_point> looked_at_;
  double credit_ms_ = 0;  ///< time that checks may take
  double ms_a_ray_ = 1;   ///< time that checks took per ray
  double ms_ = 0;         ///< time of an image, smoothed
  bool times_are_known_ = true;
  int frames_as_chosen_ = 0;
};

}  // namespace understudy::spu
