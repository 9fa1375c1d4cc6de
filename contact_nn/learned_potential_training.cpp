#include "contact_nn/learned_potential_training.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "contact_nn/potential_law.h"
#include "contact_nn/separating_axes.h"
#include "contact_nn/soap.h"
#include "contact_nn/training.h"

namespace quayside::contact_nn {

namespace {

using namespace learned;
using Eigen::MatrixXf;
using Eigen::VectorXf;
using Eigen::Vector3d;

constexpr double kDegree = M_PI / 180;
const LawParameters kElastic{6e8, 0, 0, 1e-3};  // the network does not depend on K

// A torque about the impact point counts like a force at this distance [m]: half a container.
constexpr double kArm = 5;
// Errors below this count by their square, larger ones in proportion [1]: the median matters as well as the tail.
constexpr double kSmallError = 0.03;
constexpr double kValueWeight = 4;  // of the error of log d, squared, against that of its gradient
constexpr double kLearningRate = 3e-3;
constexpr double kWarmUp = 500;  // [steps]
constexpr Eigen::Index kBatchSize = 256;
constexpr int kDegrees = 6;

Box sample_known_box(bool ground, Random& random) {
  static const double lengths[] = {3.029, 6.096, 6.858}, heights[] = {1.2955, 1.448, 0.25};
  const auto pick = [&](const double (&usual)[3], double low, double high) {
    return random.uniform() < 0.5 ? usual[random.below(3)] : random.uniform(low, high);
  };
  if (ground) return {{10 * std::pow(20, random.uniform()), 10 * std::pow(20, random.uniform()), random.uniform(0.5, 2)}};
  const double y = random.uniform() < 0.6 ? 1.219 : random.uniform(1.1, 1.35);
  return {{pick(lengths, 2.9, 7), y, pick(heights, 0.15, 1.5)}};
}

double spread(double smallest, double largest, Random& random) {
  const double size =
      random.uniform() < 0.5 ? random.uniform(0, largest) : smallest * std::pow(largest / smallest, random.uniform());
  return random.sign() * size;
}

// What is learned from: columns are samples.
struct Lessons {
  MatrixXf inputs;    // kInputs
  MatrixXf value;     // 1: log d − log_base
  MatrixXf jacobian;  // kInputs × 6, column by column: how far each input moves, in units of the target's force
  MatrixXf gradient;  // 6: what d ∇(log d − log_base) should be, in the same units
};

// Canonical gradient to force-like columns: B moved along A's axes, and turned about `centre`.
Eigen::Matrix<double, 6, 1> degrees(const PoseGradient<double>& g, const View<double>& v, const Vector3d& centre) {
  Vector3d p, turn = Vector3d::Zero(), from;
  for (int i = 0; i < 3; ++i) p[i] = g.p[i], from[i] = v.p[i];
  for (int j = 0; j < 3; ++j) {
    turn += Vector3d(v.R[0][j], v.R[1][j], v.R[2][j]).cross(Vector3d(g.R[0][j], g.R[1][j], g.R[2][j]));
  }
  turn += (from - centre).cross(p);
  Eigen::Matrix<double, 6, 1> result;
  result << p, turn / kArm;
  return result;
}

View<double> canonical_view(const BoxPair& pair, const Domain& domain) {
  const Canonical c(pair.X_AB, domain.cross_from());
  View<double> v;
  for (int i = 0; i < 3; ++i) {
    v.a[i] = pair.a.half[i];
    v.b[i] = pair.b.half[c.of_b(i)];
    v.p[i] = c.sign(i) * pair.X_AB.translation()[i];
    for (int j = 0; j < 3; ++j) v.R[i][j] = c.sign(i, j) * pair.X_AB.linear()(i, c.of_b(j));
  }
  return v;
}

Lessons lessons_from(std::size_t pairs, const Domain& domain, Random& random) {
  Lessons lessons;
  const auto n = static_cast<Eigen::Index>(pairs);
  lessons.inputs.resize(kInputs, n);
  lessons.value.resize(1, n);
  lessons.jacobian.resize(kInputs * kDegrees, n);
  lessons.gradient.resize(kDegrees, n);
  for (Eigen::Index k = 0; k < n;) {
    const double kind = random.uniform();
    const LandingPoses poses =
        kind < 0.65 ? LandingPoses::any : kind < 0.75 ? LandingPoses::edge : kind < 0.875 ? LandingPoses::resting
                                                                                        : LandingPoses::aligned;
    const BoxPair drawn = sample_landing(poses, 1.25, random, domain);
    View<double> v = canonical_view(drawn, domain);
    BoxPair pair = drawn;  // canonical, so that the target is
    for (int i = 0; i < 3; ++i) {
      pair.b.half[i] = v.b[i];
      pair.X_AB.translation()[i] = v.p[i];
      for (int j = 0; j < 3; ++j) pair.X_AB.linear()(i, j) = v.R[i][j];
    }
    const ContactForce f = potential_force(pair.a, pair.b, pair.X_AB, {}, kElastic);
    if (!f.touching) continue;
    v.scale();
    v.inputs();
    const double d = std::sqrt(2 * f.potential_energy / kElastic.stiffness);
    const Vector3d c = f.impact_point_A;
    Eigen::Matrix<double, 6, 1> target;  // d ∇ log d
    target << f.f_A, (f.t_A - c.cross(f.f_A)) / kArm;
    target *= -d / (2 * f.potential_energy);
    const double unit = target.head<3>().norm();

    PoseGradient<double> g;
    v.gradient(nullptr, 0, 1, g);
    lessons.value(0, k) = static_cast<float>(std::log(d) - v.log_base);
    lessons.gradient.col(k) = ((target - d * degrees(g, v, c)) / unit).cast<float>();
    for (int i = 0; i < kInputs; ++i) {
      double weight[kInputs] = {};
      const double x = v.input[i];
      weight[i] = i < kDepths ? 1 / std::sqrt(1 + x * x) : 1;
      v.gradient(weight, 0, 0, g);
      const auto column = (d / unit * degrees(g, v, c)).eval();
      for (int q = 0; q < kDegrees; ++q) lessons.jacobian(q * kInputs + i, k) = static_cast<float>(column[q]);
      lessons.inputs(i, k) = static_cast<float>(i < kDepths ? std::asinh(x) : x);
    }
    ++k;
  }
  return lessons;
}

// The weights of a network with two hidden layers of tanh and one output, and everything shaped like them.
struct Weights {
  MatrixXf w1, w2, w3;
  VectorXf b1, b2, b3;
};

// Value and gradient in one loss. With x the inputs, y the value and G = Jᵀ ∂y/∂x its gradient in the six degrees of
// freedom, the error is e = (y − y*, G − G*). The weights' derivative of ½|e_G|² is that of the directional derivative of y
// along J e_G, held fixed: a forward pass of tangents and one way back for values and tangents together.
class Lesson {
 public:
  double operator()(const Weights& w, const MatrixXf& x, const MatrixXf& y, const MatrixXf& J, const MatrixXf& G,
                    Weights& gradient) {
    const Eigen::Index n = x.cols();
    h1_.noalias() = w.w1 * x;
    h1_ = (h1_.colwise() + w.b1).array().tanh();
    h2_.noalias() = w.w2 * h1_;
    h2_ = (h2_.colwise() + w.b2).array().tanh();
    value_.noalias() = w.w3 * h2_;
    value_.array() += w.b3[0];
    s1_ = 1 - h1_.array().square();
    s2_ = 1 - h2_.array().square();
    // ∂y/∂x
    back2_ = s2_.array().colwise() * w.w3.row(0).transpose().array();
    sum1_.noalias() = w.w2.transpose() * back2_;
    back1_ = sum1_.array() * s1_.array();
    slope_.noalias() = w.w1.transpose() * back1_;
    // errors, weighted
    error_ = value_ - y;
    direction_.resize(x.rows(), n);
    double sum = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Map<const MatrixXf> jacobian(J.col(k).data(), kInputs, kDegrees);
      const Eigen::Matrix<float, kDegrees, 1> e = jacobian.transpose() * slope_.col(k) - G.col(k);
      const double size = kValueWeight * error_(0, k) * error_(0, k) + e.squaredNorm();
      const double rounded = std::sqrt(kSmallError * kSmallError + size);
      const float weight = static_cast<float>(1 / rounded);
      sum += rounded - kSmallError;
      error_(0, k) *= static_cast<float>(kValueWeight) * weight;
      direction_.col(k).noalias() = weight * (jacobian * e);
    }
    // tangents along `direction_`: t1 = s1 (W1 v), t2 = s2 (W2 t1), ẏ = w3 t2; loss = Σ error y + ẏ
    u1_.noalias() = w.w1 * direction_;
    t1_ = s1_.array() * u1_.array();
    u2_.noalias() = w.w2 * t1_;
    t2_ = s2_.array() * u2_.array();
    // way back
    gradient.w3.noalias() = error_ * h2_.transpose();
    gradient.w3.row(0) += t2_.rowwise().sum().transpose();
    gradient.b3[0] = error_.sum();
    const auto column3 = w.w3.row(0).transpose();
    // ∂/∂u2 = s2 w3; through s2 = 1 − h2²: −2 h2 u2 w3
    to_u2_ = back2_;
    to_h2_ = (column3 * error_).array() - 2 * h2_.array() * u2_.array() * (column3.replicate(1, n)).array();
    to_a2_ = to_h2_.array() * s2_.array();
    gradient.w2.noalias() = to_a2_ * h1_.transpose();
    gradient.w2.noalias() += to_u2_ * t1_.transpose();
    gradient.b2 = to_a2_.rowwise().sum();
    to_t1_.noalias() = w.w2.transpose() * to_u2_;
    to_h1_.noalias() = w.w2.transpose() * to_a2_;
    to_h1_.array() -= 2 * h1_.array() * u1_.array() * to_t1_.array();
    to_a1_ = to_h1_.array() * s1_.array();
    to_t1_.array() *= s1_.array();  // now of u1
    gradient.w1.noalias() = to_a1_ * x.transpose();
    gradient.w1.noalias() += to_t1_ * direction_.transpose();
    gradient.b1 = to_a1_.rowwise().sum();
    return sum / static_cast<double>(n);
  }

 private:
  MatrixXf h1_, h2_, s1_, s2_, value_, back1_, back2_, sum1_, slope_, error_, direction_, u1_, u2_, t1_, t2_, to_u2_,
      to_h2_, to_a2_, to_t1_, to_h1_, to_a1_;
};

}  // namespace

BoxPair sample_landing(LandingPoses poses, double reach, Random& random, const Domain& domain) {
  const bool may_cross = domain.outer_crossed_yaw > 0;
  for (;;) {
    const bool crossed = may_cross && random.uniform() < 0.6;
    const double widest_yaw = std::min((crossed ? domain.crossed_yaw : domain.yaw) * reach,
                                       crossed ? domain.outer_crossed_yaw : domain.outer_yaw);
    BoxPair pair{sample_known_box(random.uniform() < 0.2, random), sample_known_box(false, random), Pose::Identity()};
    double yaw = 0, tilt = 0;
    double heading = random.uniform(-M_PI, M_PI);
    const double depth_spread = random.uniform();
    double deepest = 0.03 * reach;
    const bool anywhere = poses == LandingPoses::any || poses == LandingPoses::edge;
    if (anywhere) {
      if (poses == LandingPoses::edge) heading = std::round(heading / M_PI_2) * M_PI_2 + spread(1e-5, 0.3, random);
      yaw = random.uniform(-1, 1) * widest_yaw;
      tilt = random.uniform(0, 1) * domain.tilt * reach;
    } else {
      if (random.uniform() < 0.5) yaw = random.uniform(-1, 1) * widest_yaw;
      if (poses == LandingPoses::resting) {
        tilt = 1e-12 * std::pow(1e9, random.uniform());
        yaw += 1e-12 * std::pow(1e9, random.uniform());
        deepest = 3e-3;
      }
    }
    if (crossed) yaw += M_PI_2;
    pair.X_AB.linear() = (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) *
                          Eigen::AngleAxisd(tilt, Vector3d(std::cos(heading), std::sin(heading), 0)))
                             .toRotationMatrix();
    for (int k = 0; k < 2; ++k) {
      const double a = pair.a.half[k], b = pair.b.half[k], choice = random.uniform();
      double& x = pair.X_AB.translation()[k];
      if (!anywhere && choice < 0.2) x = 0;
      else if (!anywhere && choice < 0.3) x = random.sign() * std::abs(a - b);
      else if (choice < 0.6) x = spread(1e-6, 0.1, random);
      else if (choice < 0.7) x = random.sign() * std::abs(a - b) + spread(1e-6, 0.1, random);
      else x = random.uniform(-1, 1) * (a + b - (reach > 1 ? domain.outer_overlap : domain.overlap));
    }
    // Down until the boxes overlap by this much.
    const double depth =
        depth_spread < 0.6 ? random.uniform(0, deepest) : 1e-5 * std::pow(deepest / 1e-5, random.uniform());
    double low = 0, high = 2 * (pair.a.half.norm() + pair.b.half.norm());
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      pair.X_AB.translation().z() = middle;
      (separation(pair.a, pair.b, pair.X_AB) > -depth ? high : low) = middle;
    }
    if (random.uniform() < 0.5) pair = {pair.b, pair.a, pair.X_AB.inverse(Eigen::Isometry)};
    // Offsets were drawn in one frame; the domain asks in both.
    View<double> v = canonical_view(pair, domain);
    v.scale();
    PoseGradient<double> g, ignored;
    v.gradient(nullptr, 1, 0, g);
    const double weight = domain_weight(v, crossed, domain, g, ignored);
    if (reach > 1 ? weight == 0 : weight < 1) continue;
    return pair;
  }
}

NetworkFile train_potential(const PotentialTrainingOptions& options) {
  if (options.pairs < 1000) throw std::invalid_argument("the potential needs at least 1000 pairs to learn from");
  if (options.steps < 0) throw std::invalid_argument("the number of steps must not be negative");
  Random random(1000 * options.seed);
  const Domain domain = domain_named(options.domain);
  Lessons lessons = lessons_from(options.pairs, domain, random);

  // Inputs of mean 0 and deviation 1, folded into the first layer when all is done.
  const Eigen::VectorXf mean = lessons.inputs.rowwise().mean();
  const Eigen::VectorXf deviation = ((lessons.inputs.colwise() - mean).rowwise().squaredNorm() /
                                     static_cast<float>(lessons.inputs.cols())).cwiseSqrt().cwiseMax(1e-3f);
  const Eigen::VectorXf scale = deviation.cwiseInverse();
  const float mean_value = lessons.value.mean();
  lessons.value.array() -= mean_value;
  const MatrixXf golden = lessons.inputs.leftCols(4);
  lessons.inputs = scale.asDiagonal() * (lessons.inputs.colwise() - mean);
  for (int q = 0; q < kDegrees; ++q) {
    auto rows = lessons.jacobian.middleRows(q * kInputs, kInputs);
    rows = deviation.cwiseInverse().asDiagonal() * rows;
  }

  const Network start = random_network({kInputs, kHidden, kHidden, 1}, Activation::tanh, options.seed);
  const auto cast = [&](int layer) { return start.layers[static_cast<std::size_t>(layer)].weights.cast<float>(); };
  Weights w{cast(0), cast(1), cast(2), VectorXf::Zero(kHidden), VectorXf::Zero(kHidden), VectorXf::Zero(1)}, g = w;
  Soap in(kHidden, kInputs), middle(kHidden, kHidden), out(1, kHidden);
  Lesson lesson;
  MatrixXf x(kInputs, kBatchSize), y(1, kBatchSize), J(kInputs * kDegrees, kBatchSize), G(kDegrees, kBatchSize);
  double mean_loss = 0;
  // The rate rises while the optimiser finds its axes, and then falls along a cosine.
  for (long step = 0; step < options.steps; ++step) {
    for (Eigen::Index k = 0; k < kBatchSize; ++k) {
      const auto i = static_cast<Eigen::Index>(random.below(options.pairs));
      x.col(k) = lessons.inputs.col(i);
      y.col(k) = lessons.value.col(i);
      J.col(k) = lessons.jacobian.col(i);
      G.col(k) = lessons.gradient.col(i);
    }
    const double loss = lesson(w, x, y, J, G, g);
    mean_loss += (step < 100 ? 0.1 : 0.001) * (loss - mean_loss);
    for (MatrixXf* m : {&g.w1, &g.w2, &g.w3}) *m /= kBatchSize;
    for (VectorXf* v : {&g.b1, &g.b2, &g.b3}) *v /= kBatchSize;
    const double done = static_cast<double>(step) / static_cast<double>(options.steps);
    const double rate = kLearningRate * (0.002 + 0.998 * 0.5 * (1 + std::cos(M_PI * done))) *
                        std::min(1.0, static_cast<double>(step + 1) / kWarmUp);
    in.step(w.w1, w.b1, g.w1, g.b1, rate);
    middle.step(w.w2, w.b2, g.w2, g.b2, rate);
    out.step(w.w3, w.b3, g.w3, g.b3, rate);
    if (options.progress && step % 1000 == 0) options.progress(step, mean_loss);
  }

  NetworkFile file;
  file.interface = kInterface;
  const auto layer = [](const MatrixXf& weights, const VectorXf& bias, Activation activation) {
    return Layer{weights.cast<double>(), bias.cast<double>(), activation};
  };
  const MatrixXf w1 = w.w1 * scale.asDiagonal();
  const VectorXf b1 = w.b1 - w1 * mean, b3 = w.b3.array() + mean_value;
  file.network.layers = {layer(w1, b1, Activation::tanh), layer(w.w2, w.b2, Activation::tanh),
                         layer(w.w3, b3, Activation::identity)};
  file.golden_inputs = golden.cast<double>();
  file.how_made["domain"] =
      fmt::format("{}: tilt to {:.0f} degrees, yaw to {:.0f}{}, depth to 30 mm; trained a quarter beyond", options.domain,
                  domain.tilt * 180 / M_PI, domain.yaw * 180 / M_PI,
                  domain.outer_crossed_yaw > 0
                      ? fmt::format(", crossed boxes' to {:.0f} off square", domain.crossed_yaw * 180 / M_PI)
                      : "");
  file.how_made["data"] = fmt::format(
      "{} pairs of containers, spreaders and ground: 65 % anywhere in the domain, 10 % tilted nearly about an edge, 12.5 % nearly "
      "aligned, 12.5 % exactly",
      options.pairs);
  file.how_made["seed"] = std::to_string(options.seed);
  file.how_made["training"] = fmt::format(
      "Sobolev: errors of log d and of d grad log d together; SOAP, rate {} falling along a cosine, {} steps of {}",
      kLearningRate, options.steps, kBatchSize);
  file.how_made["loss"] = fmt::format("{:.5f}", mean_loss);
  return file;
}

PotentialErrors potential_errors(const ContactModule& learned, const std::vector<BoxPair>& pairs) {
  std::vector<double> force, lever;
  ContactCounters counters;
  for (const BoxPair& pair : pairs) {
    const ContactForce exact = potential_force(pair.a, pair.b, pair.X_AB, {}, kElastic);
    if (!exact.touching) continue;
    const ContactForce f = learned.force(pair.a, pair.b, pair.X_AB, {}, counters);
    const double scale = exact.f_A.norm();
    const Vector3d c = exact.impact_point_A, difference = f.f_A - exact.f_A;
    force.push_back(difference.norm() / scale);
    lever.push_back((f.t_A - exact.t_A - c.cross(difference)).norm() / scale);
  }
  if (force.empty()) throw std::invalid_argument("no pair touches: nothing to compare");
  std::sort(force.begin(), force.end());
  std::sort(lever.begin(), lever.end());
  const auto at = [](const std::vector<double>& x, double share) {
    return x[static_cast<std::size_t>(share * static_cast<double>(x.size() - 1))];
  };
  return {at(force, 0.5), at(force, 0.99), force.back(), at(lever, 0.5), at(lever, 0.99),
          1 - static_cast<double>(counters.fallbacks) / static_cast<double>(force.size())};
}

}  // namespace quayside::contact_nn
