#include "contact_nn/mlp.h"

namespace quayside::contact_nn {

namespace {

const char* name_of(Activation activation) {
  switch (activation) {
    case Activation::identity: return "identity";
    case Activation::tanh: return "tanh";
    case Activation::relu: return "relu";
  }
  return "?";
}

}  // namespace

std::string Network::architecture() const {
  std::string text = std::to_string(inputs());
  for (const Layer& layer : layers) text += "x" + std::to_string(layer.weights.rows());
  return layers.empty() ? text : text + " " + name_of(layers.front().activation);
}

Eigen::MatrixXd activated(Activation activation, const Eigen::MatrixXd& sums) {
  switch (activation) {
    case Activation::identity: return sums;
    case Activation::tanh: return sums.array().tanh();
    case Activation::relu: return sums.array().max(0.0);
  }
  return sums;
}

Eigen::MatrixXd Network::operator()(const Eigen::MatrixXd& inputs) const {
  Eigen::MatrixXd values = inputs;
  for (const Layer& layer : layers) {
    values = activated(layer.activation, (layer.weights * values).colwise() + layer.bias);
  }
  return values;
}

}  // namespace quayside::contact_nn
