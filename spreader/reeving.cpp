#include "spreader/reeving.h"

#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

namespace quayside::spreader {
namespace {

Attachment sheave(const SheaveRectangle& rectangle, double x_side, double y_side) {
  const Eigen::Vector3d corner(x_side * rectangle.size.x() / 2, y_side * rectangle.size.y() / 2, 0);
  return {rectangle.body, rectangle.p_BR + Eigen::AngleAxisd(rectangle.turn, Eigen::Vector3d::UnitZ()) * corner};
}

}  // namespace

std::array<Rope, 4> reeve(const SheaveRectangle& upper, const SheaveRectangle& lower, const Rope& like) {
  struct Corner {
    const char* name;
    double x_side, y_side;
  };
  constexpr Corner kCorners[] = {{"rope.front_left", -1, 1},
                                 {"rope.front_right", 1, 1},
                                 {"rope.rear_left", -1, -1},
                                 {"rope.rear_right", 1, -1}};
  std::array<Rope, 4> ropes;
  for (int i = 0; i < 4; ++i) {
    ropes[i] = like;
    ropes[i].name = kCorners[i].name;
    ropes[i].upper = sheave(upper, kCorners[i].x_side, kCorners[i].y_side);
    ropes[i].lower = sheave(lower, kCorners[i].x_side, kCorners[i].y_side);
  }
  return ropes;
}

// The vertical force 4 T h/l with l² = h² + d², d the horizontal way of a rope, grows with h from nothing where the
// ropes become taut: the weight is met once, and halving finds it to the last bit.
double hanging_height(const Eigen::Vector2d& upper, const Eigen::Vector2d& lower, double axial_stiffness,
                      double rest_length, double weight) {
  assert(axial_stiffness > 0 && rest_length > 0 && weight >= 0);
  const double d = 0.5 * (upper - lower).norm();
  const auto lift = [&](double h) {
    const double length = std::hypot(h, d);
    return 4 * axial_stiffness / rest_length * (length - rest_length) * h / length;
  };
  double low = std::sqrt(std::max(0.0, rest_length * rest_length - d * d));
  double high = rest_length + d + weight * rest_length / (4 * axial_stiffness);
  while (lift(high) < weight) high *= 2;
  for (double middle = 0.5 * (low + high); low < middle && middle < high; middle = 0.5 * (low + high)) {
    (lift(middle) < weight ? low : high) = middle;
  }
  return high;
}

}  // namespace quayside::spreader
