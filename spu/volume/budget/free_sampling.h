// SPDX-License-Identifier: Apache-2.0
// Samples that are not bound to the application's own: what a request means apart from where its samples lie,
// and the same image from other samples.
#pragma once

#include <array>
#include <string>
#include <variant>

#include "volume/request.h"

namespace understudy::spu {

/// One way of taking samples.
struct Setting {
  volume::Method method = volume::Method::post_classified;
  double step = 1;            ///< from one sample to the next, in the application's own
  float termination = 5e-6F;  ///< as of RenderRequest
  bool as_halves = false;     ///< nodes' parts of the image travel as half floats
  bool operator==(const Setting&) const = default;
};

/// In words.
std::string name_of(const Setting& setting);

/// A request whose steps are a unit of length: one entry of its transfer function is what a homogeneous layer
/// one step thick shows. Steps reach from slice to slice where the application draws slices, however slantingly
/// a ray crosses them; a ray caster's steps are its own.
struct Meaning {
  volume::RenderRequest request;
  double texels_a_step = 1;  ///< along the ray through the middle of the image
};

/// Or why there is none, in words that end in the report. `size` is the texture's.
std::variant<Meaning, std::string> meaning_of(const volume::RenderRequest& request,
                                              const std::array<int, 3>& size);

/// The request with samples where the setting says, and still the opacities of whole steps.
volume::RenderRequest placed_as(const Meaning& meaning, const Setting& setting);
/// The opacities of the setting's steps.
volume::TransferFunction table_as(const Meaning& meaning, const Setting& setting);
/// Both.
volume::RenderRequest sampled_as(const Meaning& meaning, const Setting& setting);

}  // namespace understudy::spu
