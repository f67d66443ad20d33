// SPDX-License-Identifier: Apache-2.0
// Samples independent of the application's own: separates what a request shows from where its samples lie, and
// composes requests for the same image with other samples.
#pragma once

#include <array>
#include <string>
#include <variant>

#include "volume/request.h"

namespace understudy::spu {

/// How samples are taken.
struct Setting {
  volume::Method method = volume::Method::post_classified;
  double step = 1;            ///< distance between samples, in steps of the application
  float termination = 5e-6F;  ///< as in RenderRequest
  bool as_halves = false;     ///< nodes exchange parts of the image as half floats
  bool operator==(const Setting&) const = default;
};

/// Describes the setting in words.
std::string name_of(const Setting& setting);

/// A request whose step is a unit of length: an entry of its transfer function is the colour of a homogeneous
/// layer one step thick. Where the application draws slices, a step reaches from slice to slice, at any angle
/// between ray and slices; a ray caster's steps are its own.
struct Meaning {
  volume::RenderRequest request;
  double texels_a_step = 1;  ///< texels per step, along the ray through the middle of the image
};

/// Returns the meaning of a request, or the reason why it has none, for the report. `size`: the texture's, in
/// texels.
std::variant<Meaning, std::string> meaning_of(const volume::RenderRequest& request,
                                              const std::array<int, 3>& size);

/// Returns the request with samples placed as `setting` specifies, but with the opacities of whole steps.
volume::RenderRequest placed_as(const Meaning& meaning, const Setting& setting);
/// Returns the transfer function with the opacities of the setting's steps.
volume::TransferFunction table_as(const Meaning& meaning, const Setting& setting);
/// Returns the request with both.
volume::RenderRequest sampled_as(const Meaning& meaning, const Setting& setting);

}  // namespace understudy::spu
