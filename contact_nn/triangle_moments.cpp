#include "contact_nn/triangle_moments.h"

namespace quayside::contact_nn {

void TriangleMoments::flush() {
  if (filled_ == 0) return;
  constexpr double m = kNorm - 1;
  Lanes power = Lanes::Ones(), h01 = power, h = power, h1 = power, h2 = power, h11 = power, h12 = power, h22 = power;
  for (int k = 0; k < kNorm - 1; ++k) {
    power *= f0_;
    h01 = power + f1_ * h01;
    h = h01 + f2_ * h;
    h1 = h + f1_ * h1;
    h2 = h + f2_ * h2;
    h11 = h1 + f1_ * h11;
    h12 = h1 + f2_ * h12;
    h22 = h2 + f2_ * h22;
  }
  const Lanes h_next = power * f0_ + f1_ * h01 + f2_ * h;  // of order p

  const Lanes twice_area = u1_ * v2_ - u2_ * v1_;
  const Lanes one = twice_area * (1 / ((m + 1) * (m + 2)));
  const Lanes first = one * (1 / (m + 3)), second = first * (1 / (m + 4));
  const Lanes potential = one * h_next * ((m + 1) / (m + 3));
  const Lanes w = one * h, w1 = first * h1, w2 = first * h2;
  const Lanes w11 = 2 * second * h11, w12 = second * h12, w22 = 2 * second * h22;
  const Lanes u = w1 * u1_ + w2 * u2_, v = w1 * v1_ + w2 * v2_;
  const Lanes uu = w11 * u1_ * u1_ + 2 * w12 * u1_ * u2_ + w22 * u2_ * u2_;
  const Lanes uv = w11 * u1_ * v1_ + w12 * (u1_ * v2_ + u2_ * v1_) + w22 * u2_ * v2_;
  const Lanes vv = w11 * v1_ * v1_ + 2 * w12 * v1_ * v2_ + w22 * v2_ * v2_;
  for (int k = 0; k < filled_; ++k) {
    Moments& target = *target_[k];
    target.potential += potential[k];
    target.one += w[k];
    target.u += u[k];
    target.v += v[k];
    target.uu += uu[k];
    target.uv += uv[k];
    target.vv += vv[k];
  }
  filled_ = 0;
}

}  // namespace quayside::contact_nn
