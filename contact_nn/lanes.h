// Doubles that are worked on at once. Four, where the natural width is that of a vector in space: three lanes are used, the
// fourth holds anything. Eight, where many things of a kind are side by side, one to a lane. The compiler splits or widens
// them for the machine it builds for.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <Eigen/Core>

namespace quayside::contact_nn {

typedef double Four __attribute__((vector_size(32)));

inline Four four(double x, double y, double z, double w = 0) { return Four{x, y, z, w}; }
inline Four four(const Eigen::Vector3d& v) { return Four{v[0], v[1], v[2], 0}; }
inline Four load_four(const double* x) {
  Four v;
  std::memcpy(&v, x, sizeof v);
  return v;
}
inline void store_four(const Four& v, double* x) { std::memcpy(x, &v, sizeof v); }

inline Four abs(const Four& v) {
  typedef std::int64_t Bits __attribute__((vector_size(32)));
  constexpr std::int64_t all_but_sign = INT64_MAX;
  return reinterpret_cast<Four>(reinterpret_cast<Bits>(v) & (Bits{} + all_but_sign));
}

inline Four larger(const Four& a, const Four& b) { return a > b ? a : b; }
inline Four smaller(const Four& a, const Four& b) { return a < b ? a : b; }

// (y, z, x) and (z, x, y)
inline Four rotated(const Four& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
inline Four rotated_twice(const Four& v) { return __builtin_shufflevector(v, v, 2, 0, 1, 3); }

inline double sum3(const Four& v) { return v[0] + v[1] + v[2]; }

// The rows of the matrix with these three columns.
struct Rows {
  Rows(const Four& x, const Four& y, const Four& z) {
    const Four even = __builtin_shufflevector(x, y, 0, 4, 2, 6), odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
    row[0] = __builtin_shufflevector(even, z, 0, 1, 4, 4);
    row[1] = __builtin_shufflevector(odd, z, 0, 1, 5, 5);
    row[2] = __builtin_shufflevector(even, z, 2, 3, 6, 6);
  }
  Four row[3];
};

typedef double Eight __attribute__((vector_size(64)));
typedef std::int64_t EightFlags __attribute__((vector_size(64)));  // what a comparison gives: all bits set, or none

inline constexpr int kEight = 8;

inline Eight eight(double x) { return Eight{} + x; }
inline Eight load_eight(const double* x) {
  Eight v;
  std::memcpy(&v, x, sizeof v);
  return v;
}
inline void store_eight(const Eight& v, double* x) { std::memcpy(x, &v, sizeof v); }

inline Eight abs(const Eight& v) {
  return reinterpret_cast<Eight>(reinterpret_cast<EightFlags>(v) & (EightFlags{} + INT64_MAX));
}
#ifdef __AVX512F__
inline Eight larger(const Eight& a, const Eight& b) { return a > b ? a : b; }
inline Eight smaller(const Eight& a, const Eight& b) { return a < b ? a : b; }
inline Eight if_positive(const Eight& x, const Eight& yes, const Eight& no) { return x > Eight{} ? yes : no; }
#else
// Choices and shuffles between vectors wider than the machine's are taken apart lane by lane by GCC 12: halves are not.
template <class Operation, class... Others>
Eight by_halves(Operation op, const Eight& first, const Others&... others) {
  const auto half = [](const Eight& v, int which) {
    Four h;
    std::memcpy(&h, reinterpret_cast<const char*>(&v) + which * sizeof h, sizeof h);
    return h;
  };
  const Four halves[2] = {op(half(first, 0), half(others, 0)...), op(half(first, 1), half(others, 1)...)};
  Eight result;
  std::memcpy(&result, halves, sizeof result);
  return result;
}
inline Eight larger(const Eight& a, const Eight& b) {
  return by_halves([](const Four& x, const Four& y) { return larger(x, y); }, a, b);
}
inline Eight smaller(const Eight& a, const Eight& b) {
  return by_halves([](const Four& x, const Four& y) { return smaller(x, y); }, a, b);
}
inline Eight if_positive(const Eight& x, const Eight& yes, const Eight& no) {
  return by_halves([](const Four& v, const Four& y, const Four& n) { return v > Four{} ? y : n; }, x, yes, no);
}
#endif
inline Eight square_root(const Eight& v) {
  alignas(Eight) double x[kEight];
  store_eight(v, x);
  for (double& value : x) value = std::sqrt(value);
  return load_eight(x);
}

inline double least(const Eight& x) {
  double value[kEight];
  store_eight(x, value);
  for (int i = 1; i < kEight; ++i) value[0] = std::min(value[0], value[i]);
  return value[0];
}
inline double sum(const Eight& x) { return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7])); }

// Transposes an 8 × 8 matrix: neighbours are exchanged, then pairs of them, then halves.
inline void transpose(Eight (&m)[kEight]) {
#ifndef __AVX512F__
  alignas(Eight) double rows[kEight][kEight], columns[kEight][kEight];
  for (int i = 0; i < kEight; ++i) store_eight(m[i], rows[i]);
  for (int i = 0; i < kEight; ++i)
    for (int j = 0; j < kEight; ++j) columns[j][i] = rows[i][j];
  for (int i = 0; i < kEight; ++i) m[i] = load_eight(columns[i]);
  return;
#endif
  Eight t[kEight];
  for (int i = 0; i < 8; i += 2) {
    t[i] = __builtin_shufflevector(m[i], m[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    t[i + 1] = __builtin_shufflevector(m[i], m[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int i = 0; i < 8; ++i) {
    if (i & 2) continue;
    m[i] = __builtin_shufflevector(t[i], t[i + 2], 0, 1, 8, 9, 4, 5, 12, 13);
    m[i + 2] = __builtin_shufflevector(t[i], t[i + 2], 2, 3, 10, 11, 6, 7, 14, 15);
  }
  for (int i = 0; i < 4; ++i) {
    t[i] = __builtin_shufflevector(m[i], m[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    t[i + 4] = __builtin_shufflevector(m[i], m[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
  std::copy_n(t, 8, m);
}

// Lane k of the answer is what the lanes of the k-th come to under an associative operation.
template <class Operation>
Eight lanes_of_each(const Eight (&m)[kEight], Operation op) {
#ifndef __AVX512F__
  Eight lane[kEight];
  std::copy_n(m, kEight, lane);
  transpose(lane);
  return op(op(op(lane[0], lane[1]), op(lane[2], lane[3])), op(op(lane[4], lane[5]), op(lane[6], lane[7])));
#endif
  Eight t[4];
  for (int i = 0; i < 4; ++i)
    t[i] = op(__builtin_shufflevector(m[2 * i], m[2 * i + 1], 0, 8, 2, 10, 4, 12, 6, 14),
              __builtin_shufflevector(m[2 * i], m[2 * i + 1], 1, 9, 3, 11, 5, 13, 7, 15));
  for (int i = 0; i < 2; ++i)
    t[i] = op(__builtin_shufflevector(t[2 * i], t[2 * i + 1], 0, 1, 8, 9, 4, 5, 12, 13),
              __builtin_shufflevector(t[2 * i], t[2 * i + 1], 2, 3, 10, 11, 6, 7, 14, 15));
  return op(__builtin_shufflevector(t[0], t[1], 0, 1, 2, 3, 8, 9, 10, 11),
            __builtin_shufflevector(t[0], t[1], 4, 5, 6, 7, 12, 13, 14, 15));
}
inline Eight sums(const Eight (&m)[kEight]) {
  return lanes_of_each(m, [](const Eight& a, const Eight& b) { return a + b; });
}

}  // namespace quayside::contact_nn
