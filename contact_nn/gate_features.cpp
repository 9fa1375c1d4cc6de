#include "contact_nn/gate_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace quayside::contact_nn {

namespace {

// Below this share of the boxes' size a depth is rounding, and no scale to measure by.
constexpr double least_depth_share = 1e-12;

// Share of the depth up to which the scale is linear, logarithmic beyond [1].
constexpr float linear_share = 1e-8f;

// log2(x) for x ≥ 1, straight between powers of two: the bits of a float, read as a number. A network does not mind,
// and it takes two instructions.
float rough_log2(float x) {
  std::int32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  constexpr std::int32_t bits_of_one = 0x3f800000;
  return static_cast<float>(bits - bits_of_one) * 0x1p-23f;
}

}  // namespace

// Plain loops over plain arrays: this runs at every evaluation, and in fixed 3 × 3 expressions took five times as long.
GateView::GateView(const Box& a, const Box& b, const Pose& X_AB) {
  const auto R = X_AB.linear();
  const auto p = X_AB.translation();
  double far_a[3], far_b[3], sign_a[3], sign_b[3];  // distance of the centres along each axis, towards its positive end
  for (int i = 0; i < 3; ++i) {
    const double q = R(0, i) * p[0] + R(1, i) * p[1] + R(2, i) * p[2];
    far_a[i] = std::abs(p[i]);
    far_b[i] = std::abs(q);
    sign_a[i] = p[i] < 0 ? -1 : 1;
    sign_b[i] = q < 0 ? -1 : 1;
    near_a_[i] = 2 * i + (p[i] < 0 ? 1 : 0);
    near_b_[i] = 2 * i + (q < 0 ? 0 : 1);  // A is at −q from B
  }
  constexpr int padded = 48;  // a multiple of every vector's width
  float x[padded] = {};
  double reach_a[3] = {}, reach_b[3] = {};  // half the extent of A along B's axes, of B along A's
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const double tilt = R(i, j) * sign_a[i] * sign_b[j];
      const double of_a = a.half[i] * tilt, of_b = b.half[j] * tilt;
      reach_a[j] += std::abs(of_a);
      reach_b[i] += std::abs(of_b);
      x[18 + 3 * j + i] = static_cast<float>(of_a);
      x[27 + 3 * j + i] = static_cast<float>(of_b);
    }
  }
  double depth = std::numeric_limits<double>::infinity(), size = 0;
  for (int i = 0; i < 3; ++i) {
    const double overlap_a = a.half[i] + reach_b[i] - far_a[i], overlap_b = b.half[i] + reach_a[i] - far_b[i];
    depth = std::min(depth, std::min(overlap_a, overlap_b));
    size += a.half[i] + b.half[i];
    x[i] = static_cast<float>(overlap_a);
    x[3 + i] = static_cast<float>(overlap_b);
    x[6 + i] = static_cast<float>(a.half[i] - reach_b[i] - far_a[i]);  // within the near face when positive
    x[9 + i] = static_cast<float>(b.half[i] - reach_a[i] - far_b[i]);
    x[12 + i] = static_cast<float>(a.half[i] - reach_b[i] + far_a[i]);  // within the far face
    x[15 + i] = static_cast<float>(b.half[i] - reach_a[i] + far_b[i]);
  }
  const auto scale = static_cast<float>(1 / (linear_share * std::max(std::abs(depth), least_depth_share * size)));
  for (float& value : x) value = std::copysign(rough_log2(1 + std::abs(value) * scale), value);
  for (int i = 0; i < kGateInputs; ++i) inputs[i] = x[i];
}

PieceMask GateView::named(const PotentialOutputs& logits) const {
  const auto faces = [&](int group, const std::array<int, 3>& near) {
    std::uint64_t bits = 0;
    for (int axis = 0; axis < 3; ++axis) {
      bits |= std::uint64_t{logits[6 * group + 2 * axis] > 0} << near[axis];
      bits |= std::uint64_t{logits[6 * group + 2 * axis + 1] > 0} << (near[axis] ^ 1);
    }
    return bits;
  };
  const auto pieces = [](std::uint64_t faces, std::uint64_t cells) {
    std::uint64_t bits = 0;
    for (int face = 0; face < 6; ++face) bits |= (faces >> face & 1 ? cells : 0) << (6 * face);
    return bits;
  };
  static_assert(piece_index(Surface::of_a, 1, 0) == 6 && piece_index(Surface::of_b, 0, 0) == 36);
  return PieceMask(pieces(faces(0, near_a_), faces(1, near_b_))) |
         PieceMask(pieces(faces(2, near_b_), faces(3, near_a_))) << 36;
}

PotentialOutputs GateView::wanted(const PieceMask& needed) const {
  PotentialOutputs wanted = PotentialOutputs::Zero();
  const auto place = [](int number, const std::array<int, 3>& near) {  // of a face or cell within its group
    return 2 * (number / 2) + (near[number / 2] == number ? 0 : 1);
  };
  for (const Surface surface : {Surface::of_a, Surface::of_b}) {
    const bool of_a = surface == Surface::of_a;
    const int faces = of_a ? 0 : 12, cells = faces + 6;
    for (int face = 0; face < 6; ++face) {
      for (int cell = 0; cell < 6; ++cell) {
        if (!needed[piece_index(surface, face, cell)]) continue;
        wanted[faces + place(face, of_a ? near_a_ : near_b_)] = 1;
        wanted[cells + place(cell, of_a ? near_b_ : near_a_)] = 1;
      }
    }
  }
  return wanted;
}

std::array<int, 3> top_three(const PointsOutputs& outputs) {
  float value[3] = {outputs[0], -std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  std::array<int, 3> axis{0, 0, 0};
  for (int i = 1; i < kPointsOutputs; ++i) {
    const float x = outputs[i];
    const bool first = x > value[0], second = x > value[1], third = x > value[2];
    value[2] = second ? value[1] : third ? x : value[2];
    axis[2] = second ? axis[1] : third ? i : axis[2];
    value[1] = first ? value[0] : second ? x : value[1];
    axis[1] = first ? axis[0] : second ? i : axis[1];
    value[0] = first ? x : value[0];
    axis[0] = first ? i : axis[0];
  }
  return axis;
}

}  // namespace quayside::contact_nn
