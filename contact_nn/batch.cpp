#include "contact_nn/batch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "contact_nn/lanes.h"

namespace quayside::contact_nn {
namespace {

constexpr std::size_t kPairs = kEight;
Eight signed_square(const Eight& x) { return x * abs(x); }

// Eight pairs, a number of each pair to a lane.
struct Packed {
  explicit Packed(const BoxPair* pairs) {
    Eight halves[kPairs], left[kPairs], right[kPairs];  // a, b and anything; columns 0 and 1 of X_AB; columns 2 and 3
    for (std::size_t lane = 0; lane < kPairs; ++lane) {
      static_assert(sizeof(Box) == 3 * sizeof(double) && sizeof(BoxPair) >= sizeof(Eight), "half extents come first");
      std::memcpy(&halves[lane], static_cast<const void*>(&pairs[lane]), sizeof(Eight));
      const double* X = pairs[lane].X_AB.matrix().data();
      std::memcpy(&left[lane], X, sizeof(Eight));
      std::memcpy(&right[lane], X + 8, sizeof(Eight));
    }
    transpose(halves);
    transpose(left);
    transpose(right);
    for (int i = 0; i < 3; ++i) {
      a[i] = halves[i];
      b[i] = halves[3 + i];
      R[i][0] = left[i];
      R[i][1] = left[4 + i];
      R[i][2] = right[i];
      p[i] = right[4 + i];
    }
  }
  Eight a[3], b[3], p[3], R[3][3];
};

// The test of separating_axes.cpp, step by step: faces first …
struct FaceTest {
  explicit FaceTest(const Packed& x) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) R_abs[i][j] = abs(x.R[i][j]);
    for (int i = 0; i < 3; ++i)
      keep_better(i, abs(x.p[i]) - x.a[i] - (R_abs[i][0] * x.b[0] + R_abs[i][1] * x.b[1] + R_abs[i][2] * x.b[2]));
    for (int j = 0; j < 3; ++j) {
      const Eight q = x.R[0][j] * x.p[0] + x.R[1][j] * x.p[1] + x.R[2][j] * x.p[2];
      keep_better(3 + j, abs(q) - x.b[j] - (R_abs[0][j] * x.a[0] + R_abs[1][j] * x.a[1] + R_abs[2][j] * x.a[2]));
    }
  }
  void keep_better(int number, const Eight& separation) {
    const auto better = separation > gap;
    gap = better ? separation : gap;
    axis = better ? EightFlags{} + number : axis;
  }
  Eight R_abs[3][3];
  Eight gap = Eight{} - std::numeric_limits<double>::infinity();
  EightFlags axis{};
};

// … then every edge pair that wins by more than rounding.
void separations_of_eight(const Packed& x, const FaceTest& faces, GapAndAxis* answers) {
  const auto& R_abs = faces.R_abs;
  const Eight size = x.a[0] + x.a[1] + x.a[2] + x.b[0] + x.b[1] + x.b[2] + abs(x.p[0]) + abs(x.p[1]) + abs(x.p[2]);
  const Eight rounding = kAxisRounding * std::numeric_limits<double>::epsilon() * size;
  Eight numerator = faces.gap, signed_numerator = signed_square(faces.gap), squared = Eight{} + 1;
  EightFlags axis = faces.axis;
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int m = (j + 1) % 3, n = (j + 2) % 3;
      const Eight edge = abs(x.p[l] * x.R[k][j] - x.p[k] * x.R[l][j]) - (x.a[k] * R_abs[l][j] + x.a[l] * R_abs[k][j]) -
                         (x.b[m] * R_abs[i][n] + x.b[n] * R_abs[i][m]);
      const Eight sine2 = x.R[k][j] * x.R[k][j] + x.R[l][j] * x.R[l][j];
      const auto better = (signed_square(edge - rounding) * squared > signed_numerator * sine2) &
                          (sine2 >= Eight{} + kParallelSine * kParallelSine);
      numerator = better ? edge : numerator;
      signed_numerator = better ? signed_square(edge) : signed_numerator;
      squared = better ? sine2 : squared;
      axis = better ? EightFlags{} + (6 + 3 * i + j) : axis;
    }
  }
  alignas(Eight) double gap[kPairs];
  alignas(Eight) std::int64_t number[kPairs];
  store_eight(numerator / square_root(squared), gap);
  std::memcpy(number, &axis, sizeof number);
  for (std::size_t lane = 0; lane < kPairs; ++lane) answers[lane] = {gap[lane], static_cast<int>(number[lane])};
}

// The last pairs, the very last one repeated to fill the lanes.
struct FilledUp {
  FilledUp(const BoxPair* from, std::size_t count) {
    for (std::size_t lane = 0; lane < kPairs; ++lane) pairs[lane] = from[std::min(lane, count - 1)];
  }
  std::array<BoxPair, kPairs> pairs;
};

}  // namespace

void separations(const BoxPair* pairs, std::size_t count, GapAndAxis* answers) {
  std::size_t done = 0;
  for (; done + kPairs <= count; done += kPairs) {
    const Packed x(pairs + done);
    separations_of_eight(x, FaceTest(x), answers + done);
  }
  if (done == count) return;
  const FilledUp rest(pairs + done, count - done);
  const Packed x(rest.pairs.data());
  std::array<GapAndAxis, kPairs> rest_answers;
  separations_of_eight(x, FaceTest(x), rest_answers.data());
  std::copy_n(rest_answers.begin(), count - done, answers + done);
}

std::size_t find_touching(const BoxPair* pairs, std::size_t count, double margin, std::size_t* found) {
  std::size_t n = 0;
  const auto look = [&](const BoxPair* eight, std::size_t first, std::size_t real) {
    const Packed x(eight);
    const FaceTest faces(x);
    alignas(Eight) double gap[kPairs];
    std::memcpy(gap, &faces.gap, sizeof gap);
    std::array<GapAndAxis, kPairs> answers;
    bool any = false;
    for (const double g : gap) any |= g <= margin;
    if (!any) return;
    separations_of_eight(x, faces, answers.data());
    for (std::size_t lane = 0; lane < real; ++lane) {
      found[n] = first + lane;  // counted only if wanted
      n += answers[lane].gap <= margin;
    }
  };
  std::size_t done = 0;
  for (; done + kPairs <= count; done += kPairs) look(pairs + done, done, kPairs);
  if (done < count) look(FilledUp(pairs + done, count - done).pairs.data(), done, count - done);
  return n;
}

}  // namespace quayside::contact_nn
