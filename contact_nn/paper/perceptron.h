// Small tanh networks, fast to train: all weights in one padded array of floats, and one kernel for the three products
// of backpropagation. A network of the paper's size learns from 8,000 patterns in less than a millisecond.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "contact_nn/mlp.h"

namespace quayside::contact_nn::paper {

// Numbers, aligned for vectors.
using Floats = std::vector<float, Eigen::aligned_allocator<float>>;

// Samples side by side, each padded to whole vectors. Row `size` of each is 1: the input of the bias.
struct Columns {
  int size = 0;   // numbers of a sample
  int stride = 0;
  Eigen::Index count = 0;
  Floats data;

  Columns() = default;
  Columns(int size, Eigen::Index count);
  explicit Columns(const Eigen::MatrixXf& samples);  // one per column
  float* operator[](Eigen::Index i) { return data.data() + i * stride; }
  const float* operator[](Eigen::Index i) const { return data.data() + i * stride; }
};

// Where the weights of each layer are in the array. A layer is a matrix of padded columns, one per input, the last one
// the bias. What is padding is zero and stays so: its gradients are zero.
class Shape {
 public:
  explicit Shape(std::vector<int> sizes);  // inputs, hidden units ..., outputs

  struct Layer {
    int inputs, outputs;
    int stride;          // of a column
    std::size_t offset;  // of the first weight
  };
  const std::vector<Layer>& layers() const { return layers_; }
  std::size_t size() const { return size_; }  // of the array, padding included
  int weights() const { return weights_; }    // that are not padding
  std::vector<std::size_t> places() const;    // of these in the array

 private:
  std::vector<Layer> layers_;
  std::size_t size_ = 0;
  int weights_ = 0;
};

// What an error of an output costs. `absolute` is √(e² + c²) − c with c = 0.05: the absolute value, smooth near zero.
enum class Cost { square, absolute };

// Forward and backward passes over blocks of samples. Holds every intermediate value: no pass allocates after the first
// one of its size.
class Perceptron {
 public:
  explicit Perceptron(const Shape& shape) : shape_(shape) {}

  // Sum of the costs of samples [begin, begin + count) over all outputs.
  double cost(const Floats& weights, const Columns& inputs, const Columns& targets, Eigen::Index begin,
              Eigen::Index count, Cost cost);

  // The same; `gradient` becomes its derivative.
  double cost(const Floats& weights, const Columns& inputs, const Columns& targets, Eigen::Index begin,
              Eigen::Index count, Cost cost, Floats& gradient);

  // Outputs of one sample after another as rows of the Jacobian: row `count × output + sample` is the derivative of
  // that output by the weights that are not padding, in the order of `Shape::places`. `errors` (outputs × count)
  // becomes output − target.
  void jacobian(const Floats& weights, const Columns& inputs, const Columns& targets, Eigen::Index begin,
                Eigen::Index count, Eigen::MatrixXf& rows, Eigen::MatrixXf& errors);

 private:
  void forward(const Floats& weights, const Columns& inputs, Eigen::Index begin, Eigen::Index count);
  double output_errors(const Columns& targets, Eigen::Index begin, Eigen::Index count, Cost cost);
  void transpose(const Floats& weights);
  void backward_step(std::size_t layer, Eigen::Index count);

  Shape shape_;
  const float* inputs_ = nullptr;
  int input_stride_ = 0;
  std::vector<Columns> values_;  // outputs of each layer
  std::vector<Columns> errors_;  // derivative of the cost by each layer's sums
  std::vector<Floats> transposed_;
};

// The same network in the module's common form. The inputs are standardised as (x − mean)/deviation, which is folded
// into the first layer.
Network network_of(const Shape& shape, const Floats& weights, const Eigen::VectorXd& mean,
                   const Eigen::VectorXd& deviation);

}  // namespace quayside::contact_nn::paper
