#include "contact_nn/learned_potential.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "contact_nn/embedded_networks.h"
#include "contact_nn/law_parameters.h"
#include "contact_nn/separating_axes.h"

namespace quayside::contact_nn {

namespace learned {

namespace {

// From 1 to 0 as t goes from 0 to 1, with continuous second derivative; `slope` becomes its derivative.
double fade(double t, double& slope) {
  slope = 0;
  if (t <= 0) return 1;
  if (t >= 1) return 0;
  slope = -30 * t * t * (1 - t) * (1 - t);
  return 1 - t * t * t * (10 - t * (15 - 6 * t));
}

bool is_ground(const Box& x) { return x.half[0] >= 10 && x.half[1] >= 10 && x.half[2] >= 0.5; }
bool is_container(const Box& x) {
  return x.half[0] >= 2.9 && x.half[0] <= 7 && x.half[1] >= 1.1 && x.half[1] <= 1.35 && x.half[2] >= 0.15 &&
         x.half[2] <= 1.5;
}

// out = W x + b for 16 lanes; W by columns. Twelve rows at a time stay in registers.
template <int Inputs, int Outputs, class Scalar, class Lane>
void linear(const Scalar* w, const Scalar* bias, const Lane* x, Lane* out) {
  typedef Scalar Vector __attribute__((vector_size(sizeof(Lane)), may_alias));
  constexpr int block = 12;
  const auto rows = [&](auto count, int from) {
    constexpr int n = decltype(count)::value;
    Vector sum[n];
#pragma GCC unroll 12
    for (int r = 0; r < n; ++r) sum[r] = Vector{} + (bias ? bias[from + r] : Scalar(0));
    for (int c = 0; c < Inputs; ++c) {
      const Vector value = *reinterpret_cast<const Vector*>(x[c].data());
      const Scalar* column = w + c * Outputs + from;
#pragma GCC unroll 12
      for (int r = 0; r < n; ++r) sum[r] += column[r] * value;
    }
#pragma GCC unroll 12
    for (int r = 0; r < n; ++r) *reinterpret_cast<Vector*>(out[from + r].data()) = sum[r];
  };
  constexpr int whole = Outputs / block * block;
  for (int row = 0; row < whole; row += block) rows(std::integral_constant<int, block>(), row);
  if constexpr (whole < Outputs) rows(std::integral_constant<int, Outputs - whole>(), whole);
}

}  // namespace

bool known_size(const Box& a, const Box& b) {
  return (is_container(a) && (is_container(b) || is_ground(b))) || (is_ground(a) && is_container(b));
}

double domain_weight(const View<double>& v, bool crossed, const Domain& domain, const PoseGradient<double>& log_s,
                     PoseGradient<double>& g) {
  g = {};
  if (v.p[2] <= 0 || v.R[2][2] <= 0 || v.R[0][0] <= 0 || v.R[1][1] <= 0) return 0;
  const auto squared_sine = [](double angle) { return std::sin(angle) * std::sin(angle); };
  struct Factor {
    double value, slope;  // d value / d measure
  };
  const auto factor = [](double measure, double inner, double outer) {
    Factor f;
    f.value = fade((measure - inner) / (outer - inner), f.slope);
    f.slope /= outer - inner;
    return f;
  };
  std::array<Factor, 7> f;
  f[0] = factor(v.R[0][2] * v.R[0][2] + v.R[1][2] * v.R[1][2], squared_sine(domain.tilt), squared_sine(domain.outer_tilt));
  f[1] = factor(v.R[1][0] * v.R[1][0], squared_sine(crossed ? domain.crossed_yaw : domain.yaw),
                squared_sine(crossed ? domain.outer_crossed_yaw : domain.outer_yaw));
  f[2] = factor(v.s, domain.depth, domain.outer_depth);
  // Overlap along A's and B's horizontal axes, never more than it is.
  double q[2], reach[4];
  for (int k = 0; k < 2; ++k) {
    q[k] = v.R[0][k] * v.p[0] + v.R[1][k] * v.p[1] + v.R[2][k] * v.p[2];
    reach[k] = std::hypot(v.R[k][0] * v.b[0], v.R[k][1] * v.b[1]);
    reach[2 + k] = std::hypot(v.R[0][k] * v.a[0], v.R[1][k] * v.a[1]);
    f[3 + k] = factor(v.a[k] + reach[k] - std::abs(v.p[k]), domain.overlap, domain.outer_overlap);
    f[5 + k] = factor(v.b[k] + reach[2 + k] - std::abs(q[k]), domain.overlap, domain.outer_overlap);
  }
  double weight = 1;
  for (const Factor& x : f) weight *= x.value;
  if (weight == 0 || weight == 1) return weight;
  std::array<double, 7> to;
  for (std::size_t k = 0; k < f.size(); ++k) to[k] = f[k].slope == 0 ? 0 : f[k].slope * weight / f[k].value;
  for (int k = 0; k < 2; ++k) g.R[k][2] += 2 * to[0] * v.R[k][2];
  g.R[1][0] += 2 * to[1] * v.R[1][0];
  for (int i = 0; i < 3; ++i) {
    g.p[i] += to[2] * v.s * log_s.p[i];
    for (int j = 0; j < 3; ++j) g.R[i][j] += to[2] * v.s * log_s.R[i][j];
  }
  for (int k = 0; k < 2; ++k) {
    const double to_a = to[static_cast<std::size_t>(3 + k)], to_b = to[static_cast<std::size_t>(5 + k)];
    g.p[k] -= to_a * (v.p[k] < 0 ? -1 : 1);
    for (int j = 0; j < 2; ++j) {
      g.R[k][j] += to_a * v.R[k][j] * v.b[j] * v.b[j] / reach[k];
      g.R[j][k] += to_b * v.R[j][k] * v.a[j] * v.a[j] / reach[2 + k];
    }
    const double to_q = to_b * (q[k] < 0 ? 1 : -1);
    for (int i = 0; i < 3; ++i) {
      g.p[i] += to_q * v.R[i][k];
      g.R[i][k] += to_q * v.p[i];
    }
  }
  return weight;
}

Domain domain_named(const std::string& name) {
  constexpr double degree = M_PI / 180;
  Domain domain;
  if (name == kCrane) {
    domain.tilt = 4 * degree, domain.outer_tilt = 5 * degree;
    domain.yaw = 10 * degree, domain.outer_yaw = 12.5 * degree;
    domain.crossed_yaw = 40 * degree, domain.outer_crossed_yaw = 50 * degree;
  } else if (name != kLanding) {
    throw std::invalid_argument("no domain is called '" + name + "': take " + kLanding + " or " + kCrane);
  }
  return domain;
}

Domain domain_of(const NetworkFile& file) {
  const auto found = file.how_made.find("domain");
  const std::string name = found == file.how_made.end() ? "" : found->second.substr(0, found->second.find(':'));
  if (name != kLanding && name != kCrane) {
    throw std::runtime_error("the network does not say for which poses it was made: its metadata must have the key "
                             "'domain', beginning with 'landing:' or 'crane:'");
  }
  return domain_named(name);
}

template <class Scalar>
PotentialNetwork<Scalar>::PotentialNetwork(const Network& network) {
  const std::vector<Layer>& l = network.layers;
  const bool fits = l.size() == 3 && network.inputs() == kInputs && l[0].weights.rows() == kHidden &&
                    l[1].weights.rows() == kHidden && l[2].weights.rows() == 1 && l[0].activation == Activation::tanh &&
                    l[1].activation == Activation::tanh && l[2].activation == Activation::identity;
  if (!fits) {
    throw std::runtime_error("the network is " + network.architecture() + ", but " + std::to_string(kInputs) + "x" +
                             std::to_string(kHidden) + "x" + std::to_string(kHidden) + "x1 tanh is needed");
  }
  const auto transposed = [](const Layer& x) {
    return Layer{x.weights.transpose(), Eigen::VectorXd::Zero(x.weights.cols()), Activation::identity};
  };
  in_.set(l[0]);
  middle_.set(l[1]);
  in_back_.set(transposed(l[0]));
  middle_back_.set(transposed(l[1]));
  out_bias_ = static_cast<Scalar>(l[2].bias[0]);
  for (int i = 0; i < kHidden; ++i) {
    const auto row = static_cast<std::size_t>(i);
    out_[row] = static_cast<Scalar>(l[2].weights(0, i));
    b1_[row] = static_cast<Scalar>(l[0].bias[i]);
    b2_[row] = static_cast<Scalar>(l[1].bias[i]);
    for (int j = 0; j < kInputs; ++j) {
      w1_[static_cast<std::size_t>(j * kHidden + i)] = static_cast<Scalar>(l[0].weights(i, j));
      w1_back_[static_cast<std::size_t>(i * kInputs + j)] = static_cast<Scalar>(l[0].weights(i, j));
    }
    for (int j = 0; j < kHidden; ++j) {
      w2_[static_cast<std::size_t>(j * kHidden + i)] = static_cast<Scalar>(l[1].weights(i, j));
      w2_back_[static_cast<std::size_t>(i * kHidden + j)] = static_cast<Scalar>(l[1].weights(i, j));
    }
  }
}

template <class Scalar>
Scalar PotentialNetwork<Scalar>::operator()(const Scalar* input, Scalar* gradient) const {
  alignas(detail::vector_bytes) Scalar buffer[Linear<kHidden, kHidden>::padded_outputs], back[sizeof buffer / sizeof(Scalar)];
  in_(input, buffer);
  Vector h1 = Eigen::Map<const Vector>(buffer).tanh();
  middle_(h1.data(), buffer);
  const Vector h2 = Eigen::Map<const Vector>(buffer).tanh();
  const Eigen::Map<const Vector> out(out_.data());
  const Scalar value = (out * h2).sum() + out_bias_;
  const Vector back2 = out * (1 - h2.square());
  middle_back_(back2.data(), back);
  const Vector back1 = Eigen::Map<const Vector>(back) * (1 - h1.square());
  in_back_(back1.data(), gradient);
  return value;
}

template <class Scalar>
void PotentialNetwork<Scalar>::operator()(const Lane* input, Lane& value, Lane* gradient) const {
  Lane h1[kHidden], h2[kHidden], back[kHidden];
  linear<kInputs, kHidden>(w1_.data(), b1_.data(), input, h1);
  for (Lane& h : h1) h = Lane(h.tanh());
  linear<kHidden, kHidden>(w2_.data(), b2_.data(), h1, h2);
  value = Lane::Constant(out_bias_);
  for (int i = 0; i < kHidden; ++i) {
    const Scalar w = out_[static_cast<std::size_t>(i)];
    const Lane h = h2[i].tanh();
    value += w * h;
    h2[i] = w * (1 - h.square());
  }
  linear<kHidden, kHidden, Scalar, Lane>(w2_back_.data(), nullptr, h2, back);
  for (int i = 0; i < kHidden; ++i) back[i] *= 1 - h1[i].square();
  linear<kHidden, kInputs, Scalar, Lane>(w1_back_.data(), nullptr, back, gradient);
}

template class PotentialNetwork<float>;
template class PotentialNetwork<double>;

}  // namespace learned

namespace {

using namespace learned;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Wrench {
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();  // on B, torque about A's centre
};

// Minus the gradient as a wrench, back in A's own frame. Turning B about A's centre by θ changes p by θ × p and every
// column of R by θ × R_j.
Wrench wrench_of(const PoseGradient<double>& g, double factor, const Canonical& c, const Pose& X_AB) {
  Vector3d p;
  Matrix3d R;
  for (int i = 0; i < 3; ++i) {
    p[i] = c.sign(i) * g.p[i];
    for (int j = 0; j < 3; ++j) R(i, c.of_b(j)) = c.sign(i, j) * g.R[i][j];
  }
  Wrench w;
  w.force = -factor * p;
  w.torque = X_AB.translation().cross(p);
  for (int j = 0; j < 3; ++j) w.torque += X_AB.linear().col(j).cross(R.col(j));
  w.torque *= -factor;
  return w;
}

// One lane of a view.
void fill(View<double>& v, int, const Canonical& c, const Box& a, const Box& b, const Pose& X_AB) {
  for (int i = 0; i < 3; ++i) {
    v.a[i] = a.half[i];
    v.b[i] = b.half[c.of_b(i)];
    v.p[i] = c.sign(i) * X_AB.translation()[i];
    for (int j = 0; j < 3; ++j) v.R[i][j] = c.sign(i, j) * X_AB.linear()(i, c.of_b(j));
  }
}

constexpr int kLanes = 8;  // pairs whose geometry is done at once
using Lanes = Eigen::Array<double, kLanes, 1>;

void fill(View<Lanes>& v, int lane, const Canonical& c, const Box& a, const Box& b, const Pose& X_AB) {
  for (int i = 0; i < 3; ++i) {
    v.a[i][lane] = a.half[i];
    v.b[i][lane] = b.half[c.of_b(i)];
    v.p[i][lane] = c.sign(i) * X_AB.translation()[i];
    for (int j = 0; j < 3; ++j) v.R[i][j][lane] = c.sign(i, j) * X_AB.linear()(i, c.of_b(j));
  }
}

template <class Scalar>
class LearnedModuleOf final : public LearnedModule {
 public:
  LearnedModuleOf(const ContactSettings& settings, const NetworkFile& file, std::unique_ptr<ContactModule> exact)
      : parameters_(law_parameters(settings)),
        network_(file.network),
        exact_(std::move(exact)),
        domain_(domain_of(file)) {}

  Manifold query(const Box& a, const Box& b, const Pose& X_AB, ContactCounters& counters,
                 double margin) const override {
    return exact_->query(a, b, X_AB, counters, margin);
  }

  ContactForce force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                     ContactCounters& counters) const override {
    const Canonical canonical(X_AB, cross_from_);
    View<double> view;
    fill(view, 0, canonical, a, b, X_AB);
    if (!known_size(a, b) || !may_be_inside(view, canonical.crossed())) return from_exact(a, b, X_AB, V_AB, counters);
    const bool well_inside = inside(view, canonical.crossed(), 0);
    if (!well_inside && !overlaps_sideways(view)) return from_exact(a, b, X_AB, V_AB, counters);
    view.scale();
    if (!pressed(view.load)) {
      ++counters.queries;
      return {};
    }
    if (!well_inside || view.s > domain_.depth) {
      PoseGradient<double> log_s, to_weight;
      view.gradient(nullptr, 1, 0, log_s);
      const double w = domain_weight(view, canonical.crossed(), domain_, log_s, to_weight);
      if (w == 0) return from_exact(a, b, X_AB, V_AB, counters);
      if (w < 1) return blended(view, canonical, a, b, X_AB, V_AB, w, to_weight, counters);
    }
    ++counters.queries;
    ++counters.network_evaluations;
    PoseGradient<double> gradient;
    const double d = depth(view, gradient);
    return from_network(d, gradient, view.length[0], view.length[1], view.s, canonical, a, X_AB, V_AB);
  }

  void forces(const LearnedPair* pairs, std::size_t count, ContactForce* forces,
              ContactCounters& counters) const override {
    constexpr int batch = PotentialNetwork<Scalar>::kBatch;
    for (std::size_t from = 0; from < count; from += batch) {
      const int n = static_cast<int>(std::min<std::size_t>(batch, count - from));
      sixteen(pairs + from, n, forces + from, counters);
    }
  }

 private:
  // Cheap, before anything else: the weight is zero whatever the depth.
  bool may_be_inside(const View<double>& v, bool crossed) const {
    return v.R[2][2] > cos_outer_tilt_ && v.R[1][0] * v.R[1][0] < sin2_outer_yaw_[crossed] && v.R[1][1] > 0;
  }

  // If not, the weight is zero, and s means nothing: it knows no horizontal axes.
  bool overlaps_sideways(const View<double>& v) const {
    for (int k = 0; k < 2; ++k) {
      const double q = v.R[0][k] * v.p[0] + v.R[1][k] * v.p[1] + v.R[2][k] * v.p[2];
      const double reach_b = std::hypot(v.R[k][0] * v.b[0], v.R[k][1] * v.b[1]);
      const double reach_a = std::hypot(v.R[0][k] * v.a[0], v.R[1][k] * v.a[1]);
      if (v.a[k] + reach_b - std::abs(v.p[k]) <= domain_.outer_overlap) return false;
      if (v.b[k] + reach_a - std::abs(q) <= domain_.outer_overlap) return false;
    }
    return true;
  }

  // The weight is 1: bounds a little tighter than the domain's own, and only what is quick to compute.
  bool inside(const View<double>& v, bool crossed, double s) const {
    const double tilt2 = v.R[0][2] * v.R[0][2] + v.R[1][2] * v.R[1][2], yaw2 = v.R[1][0] * v.R[1][0];
    if (!(tilt2 <= sin2_tilt_ && yaw2 <= sin2_yaw_[crossed] && s <= domain_.depth)) return false;
    for (int k = 0; k < 2; ++k) {
      const double q = v.R[0][k] * v.p[0] + v.R[1][k] * v.p[1] + v.R[2][k] * v.p[2];
      if (v.a[k] + v.b[k] * v.R[k][k] - std::abs(v.p[k]) < domain_.overlap) return false;
      if (v.b[k] + v.a[k] * v.R[k][k] - std::abs(q) < domain_.overlap) return false;
    }
    return true;
  }

  // `load` is infinite, or nearly, when an axis separates the boxes.
  static bool pressed(double load) { return load < largest_load; }
  static constexpr double largest_load = 1e200;  // s below 1e-25 of the deepest corner

  // d and the gradient of log d.
  double depth(View<double>& view, PoseGradient<double>& gradient) const {
    view.inputs();
    constexpr int padded = 64;
    static_assert(padded >= kInputs && padded % (detail::vector_bytes / sizeof(float)) == 0, "room for the padding");
    alignas(detail::vector_bytes) Scalar x[padded], slope[padded];
    double weight[kInputs];
    using Depths = Eigen::Array<Scalar, kDepths, 1>;
    for (int i = 0; i < kInputs; ++i) x[i] = static_cast<Scalar>(view.input[i]);
    Eigen::Map<Depths> depths(x);
    const Depths magnitude = depths.abs(), hypotenuse = (depths.square() + 1).sqrt();
    depths = (depths < 0).select(-(magnitude + hypotenuse).log(), (magnitude + hypotenuse).log());
    const Scalar value = network_(x, slope);
    Eigen::Map<Depths>(slope) /= hypotenuse;
    for (int i = 0; i < kInputs; ++i) weight[i] = slope[i];
    view.gradient(weight, 0, 1, gradient);
    return std::exp(view.log_base + value);
  }

  ContactForce from_exact(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                          ContactCounters& counters) const {
    ContactForce f = exact_->force(a, b, X_AB, V_AB, counters);
    counters.fallbacks += f.touching;
    return f;
  }

  // From d and ∇ log d: U = ½ K d², F = −K d² ∇ log d, and what damping and friction add.
  ContactForce from_network(double d, const PoseGradient<double>& gradient, double length_x, double length_y, double s,
                            const Canonical& canonical, const Box& a, const Pose& X_AB,
                            const RelativeVelocity& V_AB) const {
    const double stored = parameters_.stiffness * d * d;
    const Wrench w = wrench_of(gradient, stored, canonical, X_AB);
    ContactForce f;
    f.touching = true;
    f.potential_energy = 0.5 * stored;
    add_motion(w, length_x, length_y, s, canonical, a, X_AB, V_AB, f);
    return f;
  }

  // Elastic wrench, damping and friction into `f`.
  void add_motion(const Wrench& w, double length_x, double length_y, double s, const Canonical& canonical, const Box& a,
                  const Pose& X_AB, const RelativeVelocity& V, ContactForce& f) const {
    const double N = w.force.norm(), inverse = 1 / N;
    const Vector3d n = w.force * inverse;
    // The line of action where it meets A's face towards B.
    Vector3d c = n.cross(w.torque) * inverse;
    c += n * ((canonical.mirror * a.half[2] - c[2]) / n[2]);
    const Vector3d v = V.v_A + V.w_A.cross(c - X_AB.translation());
    const double approach = -n.dot(v), pressed = N * std::max(0.0, 1 + parameters_.damping * approach);
    Vector3d force = pressed * n, couple = Vector3d::Zero();
    f.dissipated_power = (pressed - N) * approach;
    // Radii of the pressure; tilts from R, which are those about the other axis.
    const auto squared_radius = [&](double length, double tilt) {
      const double rise = tilt * length / s;
      return length * length / 12 / (1 + rise * rise);
    };
    const double rx2 = squared_radius(length_x, X_AB.linear()(0, 2)), ry2 = squared_radius(length_y, X_AB.linear()(1, 2));
    const Vector3d turning(-V.w_A[0] * ry2, -V.w_A[1] * rx2, 0);
    couple += parameters_.damping * N * turning;
    f.dissipated_power -= parameters_.damping * N * turning.dot(V.w_A);
    if (parameters_.friction > 0) {
      const Vector3d slide = v + approach * n;
      const double spin = n.dot(V.w_A), r2 = rx2 + ry2, squared = slide.squaredNorm() + r2 * spin * spin;
      const double k = parameters_.friction * pressed /
                       std::sqrt(squared + parameters_.transition_speed * parameters_.transition_speed);
      force -= k * slide;
      couple -= k * r2 * spin * n;
      f.dissipated_power += k * squared;
    }
    f.f_A = force;
    f.t_A = w.torque + c.cross(force - w.force) + couple;
    f.impact_point_A = c;
    f.normal_force = pressed;
    if (parameters_.pressure_radius) f.pressure_radius2 = rx2 + ry2;
  }

  // In the seam.
  ContactForce blended(View<double>& view, const Canonical& canonical, const Box& a, const Box& b, const Pose& X_AB,
                       const RelativeVelocity& V_AB, double w, const PoseGradient<double>& to_weight,
                       ContactCounters& counters) const {
    ++counters.network_evaluations;
    PoseGradient<double> gradient;
    const double d = depth(view, gradient);
    const ContactForce net = from_network(d, gradient, view.length[0], view.length[1], view.s, canonical, a, X_AB, V_AB);
    const ContactForce exact = from_exact(a, b, X_AB, V_AB, counters);
    const Wrench pull = wrench_of(to_weight, net.potential_energy - exact.potential_energy, canonical, X_AB);
    ContactForce f;
    f.touching = true;
    f.potential_energy = w * net.potential_energy + (1 - w) * exact.potential_energy;
    f.f_A = w * net.f_A + (1 - w) * exact.f_A + pull.force;
    f.t_A = w * net.t_A + (1 - w) * exact.t_A + pull.torque;
    f.impact_point_A = w * net.impact_point_A + (1 - w) * exact.impact_point_A;
    f.normal_force = w * net.normal_force + (1 - w) * exact.normal_force;
    f.dissipated_power = w * net.dissipated_power + (1 - w) * exact.dissipated_power;
    f.pressure_radius2 = w * net.pressure_radius2 + (1 - w) * exact.pressure_radius2;
    return f;
  }

  // Two views of eight pairs, one network of sixteen. Pairs that are not surely inside go one by one.
  void sixteen(const LearnedPair* pairs, int n, ContactForce* forces, ContactCounters& counters) const {
    constexpr int batch = PotentialNetwork<Scalar>::kBatch;
    using Lane = typename PotentialNetwork<Scalar>::Lane;
    View<Lanes> view[batch / kLanes];
    int used[batch];  // which pair is in which lane
    int lanes = 0;
    for (int i = 0; i < n; ++i) {
      const LearnedPair& x = pairs[i];
      if (surely_apart(x.a, x.b, x.X_AB)) {  // most pairs of a yard: not worth a view, let alone a lane
        ++counters.queries;
        forces[i] = {};
        continue;
      }
      const Canonical canonical(x.X_AB, cross_from_);
      View<double> one;
      fill(one, 0, canonical, x.a, x.b, x.X_AB);
      if (!known_size(x.a, x.b) || !inside(one, canonical.crossed(), 0)) {
        forces[i] = force(x.a, x.b, x.X_AB, x.V_AB, counters);
        continue;
      }
      fill(view[lanes / kLanes], lanes % kLanes, canonical, x.a, x.b, x.X_AB);
      used[lanes++] = i;
    }
    if (lanes == 0) return;
    for (int k = lanes; k < batch; ++k) {  // the rest repeats the last one
      const LearnedPair& x = pairs[used[lanes - 1]];
      fill(view[k / kLanes], k % kLanes, Canonical(x.X_AB, cross_from_), x.a, x.b, x.X_AB);
    }
    Lane input[kInputs], hypotenuse[kDepths], value, slope[kInputs];
    for (int h = 0; h < batch / kLanes; ++h) {
      view[h].scale();
      view[h].inputs();
      for (int i = 0; i < kInputs; ++i)
        input[i].template segment<kLanes>(h * kLanes) = view[h].input[i].template cast<Scalar>();
    }
    for (int i = 0; i < kDepths; ++i) {
      Lane& x = input[i];
      const Lane magnitude = x.abs();
      hypotenuse[i] = (x.square() + 1).sqrt();
      const Lane log = (magnitude + hypotenuse[i]).log();
      x = Lane((x < 0).select(-log, log));
    }
    network_(input, value, slope);
    for (int i = 0; i < kDepths; ++i) slope[i] /= hypotenuse[i];
    for (int h = 0; h < batch / kLanes; ++h) {
      if (h * kLanes >= lanes) break;
      Lanes weight[kInputs];
      for (int i = 0; i < kInputs; ++i) weight[i] = slope[i].template segment<kLanes>(h * kLanes).template cast<double>();
      PoseGradient<Lanes> g;
      view[h].gradient(weight, 0, 1, g);
      const Lanes d = (view[h].log_base + value.template segment<kLanes>(h * kLanes).template cast<double>()).exp();
      for (int k = 0; k < kLanes && h * kLanes + k < lanes; ++k) {
        const int i = used[h * kLanes + k];
        const LearnedPair& x = pairs[i];
        if (!pressed(view[h].load[k])) {
          ++counters.queries;
          forces[i] = {};
          continue;
        }
        if (!(view[h].s[k] <= domain_.depth)) {
          forces[i] = force(x.a, x.b, x.X_AB, x.V_AB, counters);
          continue;
        }
        ++counters.queries;
        ++counters.network_evaluations;
        PoseGradient<double> one;
        for (int r = 0; r < 3; ++r) {
          one.p[r] = g.p[r][k];
          for (int c = 0; c < 3; ++c) one.R[r][c] = g.R[r][c][k];
        }
        forces[i] = from_network(d[k], one, view[h].length[0][k], view[h].length[1][k], view[h].s[k],
                                 Canonical(x.X_AB, cross_from_),
                                 x.a, x.X_AB, x.V_AB);
      }
    }
  }

  LawParameters parameters_;
  PotentialNetwork<Scalar> network_;
  std::unique_ptr<ContactModule> exact_;
  Domain domain_;
  static double squared_sine(double angle) { return std::sin(angle) * std::sin(angle); }
  double cross_from_ = domain_.cross_from(), cos_outer_tilt_ = std::cos(domain_.outer_tilt);
  double sin2_tilt_ = squared_sine(domain_.tilt);
  double sin2_yaw_[2] = {squared_sine(domain_.yaw), squared_sine(domain_.crossed_yaw)};  // parallel, crossed
  double sin2_outer_yaw_[2] = {squared_sine(domain_.outer_yaw), squared_sine(domain_.outer_crossed_yaw)};
};

template <class Scalar>
std::unique_ptr<LearnedModule> make(const ContactSettings& settings) {
  ContactSettings exact = settings;
  exact.law = Law::potential;
  exact.network.clear();
  const NetworkFile file =
      settings.network.empty() ? shipped_potential() : read_network(settings.network, kInterface);
  return std::make_unique<LearnedModuleOf<Scalar>>(settings, file, make_contact_module(exact));
}

}  // namespace

NetworkFile shipped_potential() {
  return network_from_bytes(embedded_potential_landing(), kInterface, "potential_landing.onnx (shipped)");
}

std::unique_ptr<LearnedModule> make_learned_module(const ContactSettings& settings) { return make<float>(settings); }
std::unique_ptr<LearnedModule> make_learned_module_in_double(const ContactSettings& settings) {
  return make<double>(settings);
}

}  // namespace quayside::contact_nn
