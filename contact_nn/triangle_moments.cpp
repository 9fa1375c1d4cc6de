#include "contact_nn/triangle_moments.h"

namespace quayside::contact_nn {

void add_triangles(const Triangles& triangles, Moments& moments) {
  constexpr double m = kNorm - 1;
  const auto& [f0, u1, v1, f1, u2, v2, f2] = triangles;
  Eight power = eight(1), h01 = power, h = power, h1 = power, h2 = power, h11 = power, h12 = power, h22 = power;
  for (int k = 0; k < kNorm - 1; ++k) {
    power *= f0;
    h01 = power + f1 * h01;
    h = h01 + f2 * h;
    h1 = h + f1 * h1;
    h2 = h + f2 * h2;
    h11 = h1 + f1 * h11;
    h12 = h1 + f2 * h12;
    h22 = h2 + f2 * h22;
  }
  const Eight h_next = power * f0 + f1 * h01 + f2 * h;  // of order p

  const Eight one = (u1 * v2 - u2 * v1) * (1 / ((m + 1) * (m + 2)));
  const Eight first = one * (1 / (m + 3)), second = first * (1 / (m + 4));
  const Eight w1 = first * h1, w2 = first * h2;
  const Eight w11 = 2 * second * h11, w12 = second * h12, w22 = 2 * second * h22;
  moments.potential += one * h_next * ((m + 1) / (m + 3));
  moments.one += one * h;
  moments.u += w1 * u1 + w2 * u2;
  moments.v += w1 * v1 + w2 * v2;
  const Eight u_1 = w11 * u1 + w12 * u2, u_2 = w12 * u1 + w22 * u2;
  moments.uu += u_1 * u1 + u_2 * u2;
  moments.uv += u_1 * v1 + u_2 * v2;
  moments.vv += (w11 * v1 + w12 * v2) * v1 + (w12 * v1 + w22 * v2) * v2;
}

}  // namespace quayside::contact_nn
