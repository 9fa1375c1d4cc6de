#include "contact_nn/soap.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace quayside::contact_nn {

namespace {

// What running means keep of what they had [1].
constexpr double kMean = 0.95, kSquare = 0.99;
constexpr float kCovariance = 0.99f;

constexpr long kTurnEvery = 10;      // steps between turns of the axes: they move slowly, and turning is dear
constexpr float kLeastSlope = 1e-9f; // of a gradient that is not rounding [1]

}  // namespace

Soap::Soap(Eigen::Index outputs, Eigen::Index inputs)
    : rows_(Eigen::MatrixXf::Zero(outputs, outputs)),
      columns_(Eigen::MatrixXf::Zero(inputs + 1, inputs + 1)),
      row_axes_(rows_),
      column_axes_(columns_),
      mean_(Eigen::MatrixXf::Zero(outputs, inputs + 1)),
      square_(mean_),
      gradient_(mean_) {}

// One power iteration from the axes so far, which is enough for what changes in a few steps.
void Soap::turn_axes() {
  const auto turned = [](const Eigen::MatrixXf& covariance, const Eigen::MatrixXf& axes) -> Eigen::MatrixXf {
    return Eigen::HouseholderQR<Eigen::MatrixXf>(covariance * axes).householderQ();
  };
  row_axes_ = turned(rows_, row_axes_);
  column_axes_ = turned(columns_, column_axes_);
}

void Soap::step(Eigen::MatrixXf& weights, Eigen::VectorXf& bias, const Eigen::MatrixXf& weights_gradient,
                const Eigen::VectorXf& bias_gradient, double rate) {
  gradient_ << weights_gradient, bias_gradient;
  rows_ *= kCovariance;
  rows_.noalias() += (1 - kCovariance) * gradient_ * gradient_.transpose();
  columns_ *= kCovariance;
  columns_.noalias() += (1 - kCovariance) * gradient_.transpose() * gradient_;
  if (steps_ == 0) {
    row_axes_ = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf>(rows_).eigenvectors();
    column_axes_ = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf>(columns_).eigenvectors();
  } else if (steps_ % kTurnEvery == 0) {
    turn_axes();
  }
  ++steps_;
  const auto into_axes = [&](const Eigen::MatrixXf& x) {
    part_.noalias() = row_axes_.transpose() * x;
    turned_.noalias() = part_ * column_axes_;
  };
  into_axes(gradient_);
  square_ = float(kSquare) * square_ + float(1 - kSquare) * turned_.cwiseAbs2();
  mean_ = float(kMean) * mean_ + float(1 - kMean) * gradient_;
  into_axes(mean_);
  turned_.array() /= square_.array().sqrt() + kLeastSlope;
  part_.noalias() = row_axes_ * turned_;
  turned_.noalias() = part_ * column_axes_.transpose();
  const double steps = static_cast<double>(steps_);
  const auto length = static_cast<float>(rate * std::sqrt(1 - std::pow(kSquare, steps)) / (1 - std::pow(kMean, steps)));
  weights -= length * turned_.leftCols(weights.cols());
  bias -= length * turned_.rightCols<1>();
}

}  // namespace quayside::contact_nn
