// A method that finds where two boxes touch, behind one face, so that all are asked the same and timed alike.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "contact_nn/contact.h"

namespace quayside::peers {

using contact_nn::Box;

// Orientation and position in the world. Not a contact_nn::Pose: the layout of that depends on the vector width it is compiled
// for, and some methods must be compiled for the width of their libraries.
struct Placement {
  Eigen::Matrix3d R;
  Eigen::Vector3d p;

  Placement(const contact_nn::Pose& X) : R(X.linear()), p(X.translation()) {}
  contact_nn::Pose pose() const {
    contact_nn::Pose X = contact_nn::Pose::Identity();
    X.linear() = R;
    X.translation() = p;
    return X;
  }
};

// Two boxes, as a collision detector is given them.
struct Placed {
  Box a, b;
  Placement X_WA, X_WB;
};

// What a method says, brought to one form. NaN stands for what it does not give.
struct Answer {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  bool touching = false;
  int count = 0;         // of points, triangles' contacts or the like
  double depth = kNone;  // positive when penetrating [m]
  Eigen::Vector3d n_W = Eigen::Vector3d::Constant(kNone);      // unit, from A to B
  Eigen::Vector3d point_W = Eigen::Vector3d::Constant(kNone);  // mean of the points, weighted by their depths [m]
};

enum class Kind { ours, box_routine, convex, mesh };

class Contender {
 public:
  Contender(std::string name, Kind kind) : name(std::move(name)), kind(kind) {}
  virtual ~Contender() = default;

  // Brings all pairs into the method's own form, as an engine keeps them. Not timed.
  virtual void load(const std::vector<Placed>& pairs) = 0;

  // Finds the contact of pair i and keeps what was found. This is what is timed. The returned number depends on the result,
  // so that nothing can be optimised away.
  virtual double query(std::size_t i) = 0;

  // All of the first pairs in one go, timed as a pass; for a method that works on many at once.
  virtual double pass(std::size_t count) {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += query(i);
    return sum;
  }

  // What the last query found. Not timed.
  virtual Answer answer() const = 0;

  // What is measured, for the reader of the results.
  virtual std::string note() const = 0;

  const std::string name;
  const Kind kind;
  bool gives_point = true;
  double mesh_resolution = 0;      // r of the paper's grid [1]; 0: no mesh

  // What the check asks of it on cubes of edge 2 m.
  double check_tolerance = 1e-3;        // of depth [m] and normal [rad]
  double check_point_tolerance = 1e-3;  // of the point, beyond the depth [m]
  double reported_depth = 1;            // a share of the depth that it is known to report [1]
};

using Contenders = std::vector<std::unique_ptr<Contender>>;

// The mean of points weighted by their depths, gathered one by one: the centre of equal springs at the points.
class WeightedPoints {
 public:
  void add(const Eigen::Vector3d& p_W, double depth) {
    ++count_;
    deepest_ = std::max(deepest_, depth);
    const double weight = std::max(depth, 0.0);
    weighted_ += weight * p_W;
    weight_ += weight;
    plain_ += p_W;
  }
  int count() const { return count_; }
  double deepest() const { return deepest_; }
  Eigen::Vector3d mean() const { return weight_ > 0 ? Eigen::Vector3d(weighted_ / weight_) : Eigen::Vector3d(plain_ / count_); }

 private:
  int count_ = 0;
  double deepest_ = -std::numeric_limits<double>::infinity(), weight_ = 0;
  Eigen::Vector3d weighted_ = Eigen::Vector3d::Zero(), plain_ = Eigen::Vector3d::Zero();
};

void add_ours(Contenders& all);
void add_ode_and_mujoco(Contenders& all);
void add_libccd(Contenders& all);

// Adds what a module makes, a shared library that exports `extern "C" void add_contenders(quayside::peers::Contenders&)`. Modules
// keep apart what cannot be linked into one program; they stay loaded until it ends.
void add_module(const char* file, Contenders& all);

}  // namespace quayside::peers
