// Four doubles that are worked on at once, for code whose natural width is that of a vector in space: three lanes are
// used, the fourth holds anything. The compiler splits or widens them for the machine it builds for.
#pragma once

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

}  // namespace quayside::contact_nn
