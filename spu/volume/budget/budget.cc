// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/budget/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compositor/rendered.h"
#include "compositor/service.h"
#include "spu/report/counters.h"
#include "volume/image.h"
#include "volume/raycast/segment_scene.h"

namespace understudy::spu {
namespace {

using volume::Pixel;

/// Share of the requested error that early ray termination may use.
constexpr double share_of_termination = 0.125;
constexpr float finest_termination = 5e-6F;
constexpr float coarsest_termination = 0.02F;
/// Few rays are checked: the calibrated error must leave this much room for the others.
constexpr double room_for_others = 0.6;
/// The same, after the worst pixels of an image have been checked.
constexpr double room_when_proven = 0.7;
/// Share of the elapsed time that checks may take.
constexpr double share_of_looking = 0.02;
constexpr double most_credit_ms = 10;
constexpr std::size_t proving_suspects = 48;
constexpr std::size_t proving_spread = 128;
constexpr double proving_ms = 150;
constexpr int patient_frames = 4;            ///< before a limit of time changes the setting again
constexpr double finest_samples = 1.0 / 32;  ///< in texels, which are interpolated linearly in between
/// Images that are timed with floats and with half floats. Half floats are worth their error if they take less
/// than `worthwhile` of the time.
constexpr int turns_to_compare = 3;
constexpr double worthwhile = 0.95;

float termination_for(const BudgetAsked& asked) {
  if (asked.error > 0)
    return std::clamp(float(asked.error * share_of_termination), finest_termination, coarsest_termination);
  return 1e-3F;
}

}  // namespace

std::optional<volume::RenderRequest> Budget::request(
    compositor::ImageService& service, const volume::RenderRequest& own, const std::string& obstacle,
    const volume::VolumeDescription& volume, std::uint64_t service_generation, BudgetCounters& counters) {
  counters.asked_error = asked_.error;
  counters.asked_ms = asked_.ms;
  std::variant<Meaning, std::string> meaning = obstacle;
  if (obstacle.empty()) meaning = meaning_of(own, volume.size);
  if (const auto* reason = std::get_if<std::string>(&meaning)) {
    put_text(counters.setting, "the application's own samples");
    put_text(counters.note, "a budget cannot be kept: " + *reason);
    return std::nullopt;
  }
  meaning_ = std::get<Meaning>(std::move(meaning));
  const MeasuredFor now{volume.id, volume.version, service_generation, own.classification};
  if (measured_for_ != now) {
    times_are_known_ = !service.loads_for_images();
    calibration_ = calibrate(service, meaning_, volume, termination_for(asked_), asked_.error / 3);
    measured_for_ = now;
    table_.reset();
    ++counters.calibrations;
    choose();
    if (asked_.error > 0) {
      prove(service);
      if (asked_.may_halve && service.nodes() > 1 && !service.loads_for_images()) try_halves(service);
    }
    looked_at_ = Clock::now();
  }
  if (!keep_ghost_layer(volume)) {
    put_text(counters.note, "a budget cannot be kept: rays run along the slices");
    return std::nullopt;
  }
  tell(counters);
  const Setting now_used = setting();
  if (!table_ || table_for_ != now_used) {
    table_ = table_as(meaning_, now_used);
    table_for_ = now_used;
  }
  volume::RenderRequest request = placed_as(meaning_, now_used);
  request.classification = *table_;
  return request;
}

/// Selects a setting whose segments, longer as the camera turns, fit in the nodes' ghost layer; false if none
/// does.
bool Budget::keep_ghost_layer(const volume::VolumeDescription& volume) {
  const auto& front = calibration_.front;
  const auto fits = [&](std::size_t i) {
    return volume::ghost_layer_needed(volume, placed_as(meaning_, front[i].setting)) <= volume.ghost_layer;
  };
  if (fits(chosen_)) return true;
  const auto finer = chosen_ + 1;
  for (std::size_t i = finer; i < front.size(); ++i)
    if (fits(i)) {
      use(i);
      return true;
    }
  for (std::size_t i = chosen_; i-- > 0;)
    if (fits(i)) {
      use(i);
      return true;
    }
  return false;
}

void Budget::choose() {
  const auto& front = calibration_.front;
  // Along the front, errors decrease and times increase.
  const auto good =
      asked_.error > 0
          ? std::ranges::find_if(
                front,
                [&](const Measured& measured) { return measured.error <= room_for_others * asked_.error; })
          : std::ranges::find_if(front, [&](const Measured& measured) { return measured.ms > asked_.ms; });
  chosen_ = std::size_t(good - front.begin());
  if (asked_.error > 0 && good == front.end()) chosen_ = front.size() - 1;
  if (!(asked_.error > 0)) chosen_ = std::max<std::size_t>(chosen_, 1) - 1;
  use(chosen_);
}

/// Selects a setting with its calibrated error and time; no image of it has been checked.
void Budget::use(std::size_t of_front) {
  chosen_ = of_front;
  as_halves_ = false;
  worst_ = calibration_.front[chosen_].error;
  ms_ = calibration_.front[chosen_].ms;
  frames_as_chosen_ = 0;
}

/// Checks the pixels that a finer setting changes most, where errors are likeliest; goes finer until they are
/// small.
void Budget::prove(compositor::ImageService& service) {
  const auto& front = calibration_.front;
  do {
    const std::array requests{sampled_as(meaning_, next_finer().setting),
                              sampled_as(meaning_, front[chosen_].setting)};
    const std::vector<volume::Image> images = service.images(requests);
    const volume::ImageView finer = images[0].view(), shown = images[1].view();
    suspects_ = most_different(shown, finer, proving_suspects);
    std::vector<Pixel> pixels = suspects_;
    const std::vector<Pixel> spread = spread_over(shown.rect, spread_, proving_spread);
    pixels.insert(pixels.end(), spread.begin(), spread.end());
    const auto integrals = integrals_of(service, meaning_.request, pixels, suspects_.size(), proving_ms);
    spread_ += proving_spread;
    worst_ = greatest_error(shown, pixels, integrals);
    if (integrals.size() < suspects_.size()) worst_ = std::max(worst_, front[chosen_].error);
  } while (worst_ > room_when_proven * asked_.error && go_finer());
}

/// Uses half floats between nodes if they save time and their rounding stays within the error.
void Budget::try_halves(compositor::ImageService& service) {
  if (worst_ > room_when_proven * asked_.error) return;
  volume::RenderRequest request = sampled_as(meaning_, setting());
  std::array<double, 2> least{1e300, 1e300};
  compositor::Rendered in_halves;
  for (int turn = 0; turn < 2 * turns_to_compare; ++turn) {
    request.may_travel_as_halves = turn % 2 == 1;
    request.termination = std::nextafter(request.termination, 1.0F);  // an equal request is not cast again
    const auto start = Clock::now();
    in_halves = service.render(request);
    const std::chrono::duration<double, std::milli> took = Clock::now() - start;
    double& best = least[std::size_t(turn % 2)];
    best = std::min(best, took.count());
  }
  if (least[1] > worthwhile * least[0]) return;
  std::vector<Pixel> pixels = suspects_;
  const std::vector<Pixel> spread = spread_over(in_halves.image.rect, spread_, proving_spread);
  pixels.insert(pixels.end(), spread.begin(), spread.end());
  const auto integrals = integrals_of(service, meaning_.request, pixels, suspects_.size(), proving_ms);
  const double worst = greatest_error(in_halves.image, pixels, integrals);
  if (worst > room_when_proven * asked_.error) return;
  as_halves_ = true;
  worst_ = worst;
  ms_ = least[1];
}

Setting Budget::setting() const {
  Setting setting = calibration_.front[chosen_].setting;
  setting.as_halves = as_halves_;
  return setting;
}

/// Calibration stops where its few rays were exact enough. A finer setting is assumed to have the same error
/// and twice the cost until it is checked.
Measured Budget::next_finer() const {
  const auto& front = calibration_.front;
  if (chosen_ + 1 < front.size()) return front[chosen_ + 1];
  Measured finer = front.back();
  finer.setting.step /= 2;
  finer.ms *= 2;
  return finer;
}

bool Budget::go_finer() {
  if (as_halves_) {
    use(chosen_);
    return true;
  }
  if (chosen_ + 1 >= calibration_.front.size()) {
    const Measured finer = next_finer();
    if (finer.setting.step * meaning_.texels_a_step < finest_samples) return false;
    calibration_.front.push_back(finer);
  }
  use(chosen_ + 1);
  return true;
}

void Budget::look_at(compositor::ImageService& service, const volume::ImageView& image,
                     std::optional<double> ms, BudgetCounters& counters) {
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<double, std::milli> passed = now - looked_at_.value_or(now);
  looked_at_ = now;
  // A reused image leaves the time that casting it would have taken.
  credit_ms_ = std::min(credit_ms_ + share_of_looking * passed.count() + (ms ? 0 : ms_), most_credit_ms);
  if (ms) ms_ = frames_as_chosen_++ == 0 ? *ms : 0.8 * ms_ + 0.2 * *ms;
  const auto count = std::size_t(std::max(0.0, credit_ms_) / ms_a_ray_);
  if (count > 0 && !image.rect.empty()) {
    // Half of the pixels are suspects, the others are spread over the image.
    std::vector<Pixel> pixels = spread_over(image.rect, spread_, (count + 1) / 2);
    spread_ += pixels.size();
    for (std::size_t i = 0; i < count / 2 && i < suspects_.size(); ++i) pixels.push_back(suspects_[i]);
    if (!suspects_.empty())
      std::rotate(suspects_.begin(),
                  suspects_.begin() + std::ptrdiff_t(std::min(count / 2, suspects_.size() - 1)),
                  suspects_.end());
    const auto integrals = service.integrals(meaning_.request, pixels, credit_ms_);
    const std::chrono::duration<double, std::milli> took = Clock::now() - now;
    credit_ms_ -= took.count();
    if (!integrals.empty()) ms_a_ray_ = 0.5 * (ms_a_ray_ + took.count() / double(integrals.size()));
    worst_ = std::max(worst_, greatest_error(image, pixels, integrals));
    counters.rays += integrals.size();
  }
  if (asked_.error > 0 && worst_ > asked_.error) {
    ++counters.images_over;
    go_finer();
  } else if (!(asked_.error > 0) && ms) {
    keep_time();
  }
  tell(counters);
}

/// Moves along the front by one if images take more, or clearly less, than the requested time.
void Budget::keep_time() {
  const auto& front = calibration_.front;
  if (frames_as_chosen_ < patient_frames) return;
  if (ms_ > asked_.ms && chosen_ > 0) {
    use(chosen_ - 1);
  } else if (chosen_ + 1 < front.size() && front[chosen_ + 1].ms / front[chosen_].ms * ms_ < 0.9 * asked_.ms) {
    use(chosen_ + 1);
  }
}

void Budget::tell(BudgetCounters& counters) const {
  counters.measured = worst_;
  counters.ms = ms_;
  put_text(counters.setting, name_of(setting()));
  std::string note;
  // Otherwise a finer setting would have been chosen.
  if (asked_.error > 0 && worst_ > asked_.error)
    note = fmt::format("the error that is asked for cannot be kept: {:.2g} is the best there is here{}", worst_,
                       times_are_known_ ? fmt::format(", at {:.3g} ms an image", ms_) : "");
  if (!(asked_.error > 0) && ms_ > asked_.ms && chosen_ == 0)
    note = fmt::format("the time that is asked for cannot be kept: {:.3g} ms is the least there is here", ms_);
  put_text(counters.note, note);
}

}  // namespace understudy::spu
