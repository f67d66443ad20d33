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
  std::uint64_t identity = 0;  ///< of its texture (ShareGroup)
  SentVolume sent;
  KnownColours colours;
  KnownMarch march;  ///< if a ray caster draws it
  VerifiedVolume verified;
  RefusalHistory refusals;
  SpeedGuard speed;
  std::unique_ptr<Budget> budget;  ///< if an error or a time was requested
  bool exported = false;           ///< its scene was saved, or can never be
  bool depth_looked_at = false;    ///< the depth that its slices write was read
  std::uint64_t frames = 0;        ///< in which it was substituted since it was last measured
  VolumeCounters* counters = nullptr;
};

}  // namespace understudy::spu
