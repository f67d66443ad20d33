// SPDX-License-Identifier: Apache-2.0
// Layers of other lengths than a step. A part of vector_kernel.cc and vector_segments-inl.h, included there
// once per instruction set, after vector_field-inl.h; requires hwy/contrib/math.

/// The factor from colours of layers one step long, with opacity `alpha`, to those of length `length`.
HWY_INLINE Floats share_of_layer(Floats length, Floats alpha) {
  const FloatTag f;
  const Floats zero = hn::Zero(f), one = hn::Set(f, 1.0F);
  // The logarithm requires less than full opacity; full opacity stays unchanged.
  const Floats passing = hn::Min(alpha, hn::Set(f, 1 - std::numeric_limits<float>::epsilon()));
  const Floats depth = hn::Mul(length, hn::Log1p(f, hn::Neg(passing)));
  const Floats kept = hn::IfThenElse(hn::Lt(alpha, one), hn::Neg(hn::Expm1(f, depth)), one);
  const Floats share = hn::IfThenElse(hn::Gt(alpha, zero), hn::Div(kept, alpha), length);
  return hn::IfThenElseZero(hn::Gt(length, zero), share);
}

HWY_INLINE void multiply(Floats by, Colours& colours) {
  colours[0] = hn::Mul(colours[0], hn::Broadcast<0>(by));
  colours[1] = hn::Mul(colours[1], hn::Broadcast<1>(by));
  colours[2] = hn::Mul(colours[2], hn::Broadcast<2>(by));
  colours[3] = hn::Mul(colours[3], hn::Broadcast<3>(by));
}

/// Converts colours of layers one step long to layers of length `length`.
HWY_INLINE void resize_layers(Floats length, Colours& colours) {
  multiply(share_of_layer(length, alphas(colours)), colours);
}
