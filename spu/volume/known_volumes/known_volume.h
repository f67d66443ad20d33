// SPDX-License-Identifier: Apache-2.0
// What is remembered of one volume between frames: a part for every stage.
#pragma once

#include <cstdint>
#include <memory>

#include "spu/volume/budget/budget.h"
#include "spu/volume/classification/known_colours.h"
#include "spu/volume/proxy/known_march.h"
#include "spu/volume/refusal/refusal.h"
#include "spu/volume/timing/speed_guard.h"
#include "spu/volume/upload/sent_volume.h"
#include "spu/volume/verification/verified_volume.h"

namespace understudy::spu {

struct VolumeCounters;

struct KnownVolume {
  SentVolume sent;
  KnownColours colours;
  KnownMarch march;  ///< where it is drawn by a ray caster
  VerifiedVolume verified;
  RefusalHistory refusals;
  SpeedGuard speed;
  std::unique_ptr<Budget> budget;  ///< where an error or a time is asked for
  bool depth_looked_at = false;    ///< somebody used the depth that its slices write
  std::uint64_t frames = 0;        ///< in which it was substituted, since it was measured last
  VolumeCounters* counters = nullptr;
};

}  // namespace understudy::spu
