#include "contact_nn/paper/perceptron.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace quayside::contact_nn::paper {

namespace {

using Vector = detail::VectorOf<float>::type;
constexpr int lanes = detail::VectorOf<float>::lanes;
constexpr float smooth = 0.05f;  // c of the absolute cost [rad]: well below the errors in question

constexpr int padded(int n) { return (n + lanes - 1) / lanes * lanes; }

const Vector* vectors(const float* p) { return reinterpret_cast<const Vector*>(p); }
Vector* vectors(float* p) { return reinterpret_cast<Vector*>(p); }

// A right-hand factor read number by number: element (k, j) is at[k · row + j · column].
struct Scalars {
  const float* at;
  std::ptrdiff_t row, column;
};

// `height` vectors of rows of `width` columns of C = A B, everything in registers.
template <int height, int width>
void product_tile(const float* a, int a_stride, const Scalars& b, Eigen::Index depth, float* c, int c_stride) {
  Vector sum[height][width];
  for (int i = 0; i < height; ++i) {
    for (int j = 0; j < width; ++j) sum[i][j] = Vector{};
  }
  for (Eigen::Index k = 0; k < depth; ++k) {
    const Vector* column = vectors(a + k * a_stride);
    const float* scalars = b.at + k * b.row;
#pragma GCC unroll 4
    for (int j = 0; j < width; ++j) {
      const float x = scalars[j * b.column];
#pragma GCC unroll 4
      for (int i = 0; i < height; ++i) sum[i][j] += column[i] * x;
    }
  }
  for (int j = 0; j < width; ++j) {
    for (int i = 0; i < height; ++i) vectors(c + j * c_stride)[i] = sum[i][j];
  }
}

template <int height>
void product_rows(const float* a, int a_stride, Scalars b, Eigen::Index depth, Eigen::Index columns, float* c,
                  int c_stride) {
  constexpr int width = 4;
  Eigen::Index j = 0;
  for (; j + width <= columns; j += width) {
    product_tile<height, width>(a, a_stride, b, depth, c + j * c_stride, c_stride);
    b.at += width * b.column;
  }
  for (; j < columns; ++j) {
    product_tile<height, 1>(a, a_stride, b, depth, c + j * c_stride, c_stride);
    b.at += b.column;
  }
}

// C (rows × columns) = A (rows × depth) B (depth × columns); rows is a multiple of the lanes, columns of A and C lie
// `a_stride` and `c_stride` numbers apart. All three products of backpropagation have this form, with A the weights,
// the transposed weights, and the errors.
void product(int rows, const float* a, int a_stride, const Scalars& b, Eigen::Index depth, Eigen::Index columns,
             float* c, int c_stride) {
  int row = 0;
  for (; row + 2 * lanes <= rows; row += 2 * lanes)
    product_rows<2>(a + row, a_stride, b, depth, columns, c + row, c_stride);
  if (row < rows) product_rows<1>(a + row, a_stride, b, depth, columns, c + row, c_stride);
}

}  // namespace

Columns::Columns(int size_, Eigen::Index count_)
    : size(size_), stride(padded(size_ + 1)), count(count_), data(static_cast<std::size_t>(stride * count_), 0.0f) {
  for (Eigen::Index i = 0; i < count; ++i) (*this)[i][size] = 1;
}

Columns::Columns(const Eigen::MatrixXf& samples) : Columns(static_cast<int>(samples.rows()), samples.cols()) {
  for (Eigen::Index i = 0; i < count; ++i) std::copy_n(samples.col(i).data(), size, (*this)[i]);
}

Shape::Shape(std::vector<int> sizes) {
  assert(sizes.size() >= 2);
  for (std::size_t i = 0; i + 1 < sizes.size(); ++i) {
    const int stride = padded(sizes[i + 1] + 1);
    layers_.push_back({sizes[i], sizes[i + 1], stride, size_});
    size_ += static_cast<std::size_t>(stride * (sizes[i] + 1));
    weights_ += sizes[i + 1] * (sizes[i] + 1);
  }
}

std::vector<std::size_t> Shape::places() const {
  std::vector<std::size_t> places;
  for (const Layer& layer : layers_) {
    for (int j = 0; j <= layer.inputs; ++j) {
      for (int i = 0; i < layer.outputs; ++i)
        places.push_back(layer.offset + static_cast<std::size_t>(j * layer.stride + i));
    }
  }
  return places;
}

// The row behind the last output of a layer is set to 1 after the activation, so the next layer finds the input of its
// bias there; tanh' = 1 − y² is zero at 1, so no error flows back into it.
void Perceptron::forward(const Floats& weights, const Columns& inputs, Eigen::Index begin, Eigen::Index count) {
  const auto& layers = shape_.layers();
  assert(inputs.size == layers.front().inputs && begin + count <= inputs.count);
  if (values_.empty() || values_.front().count < count) {
    values_.clear();
    errors_.clear();
    for (const auto& layer : layers) {
      values_.emplace_back(layer.outputs, count);
      errors_.emplace_back(layer.outputs, count);
    }
  }
  inputs_ = inputs[begin];
  input_stride_ = inputs.stride;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const auto& layer = layers[l];
    const float* x = l == 0 ? inputs_ : values_[l - 1].data.data();
    const int x_stride = l == 0 ? input_stride_ : values_[l - 1].stride;
    float* y = values_[l].data.data();
    product(layer.stride, weights.data() + layer.offset, layer.stride, {x, 1, x_stride}, layer.inputs + 1, count, y,
            layer.stride);
    if (l + 1 == layers.size()) break;
    Eigen::Map<Eigen::ArrayXf, Eigen::AlignedMax> all(y, layer.stride * count);
    all = all.tanh();
    for (Eigen::Index s = 0; s < count; ++s) y[s * layer.stride + layer.outputs] = 1;
  }
}

double Perceptron::output_errors(const Columns& targets, Eigen::Index begin, Eigen::Index count, Cost cost) {
  double sum = 0;
  for (Eigen::Index s = 0; s < count; ++s) {
    const float* y = values_.back()[s];
    const float* t = targets[begin + s];
    float* error = errors_.back()[s];
    std::fill_n(error, errors_.back().stride, 0.0f);
    float part = 0;
    for (int i = 0; i < targets.size; ++i) {
      const float e = y[i] - t[i];
      if (cost == Cost::square) {
        part += 0.5f * e * e;
        error[i] = e;
      } else {
        const float root = std::sqrt(e * e + smooth * smooth);
        part += root - smooth;
        error[i] = e / root;
      }
    }
    sum += part;
  }
  return sum;
}

double Perceptron::cost(const Floats& weights, const Columns& inputs, const Columns& targets, Eigen::Index begin,
                        Eigen::Index count, Cost cost) {
  forward(weights, inputs, begin, count);
  return output_errors(targets, begin, count, cost);
}

// Wᵀ of every layer but the first, which nothing flows back through.
void Perceptron::transpose(const Floats& weights) {
  const auto& layers = shape_.layers();
  transposed_.resize(layers.size());
  for (std::size_t l = 1; l < layers.size(); ++l) {
    const auto& layer = layers[l];
    const int stride = padded(layer.inputs + 1);
    transposed_[l].resize(static_cast<std::size_t>(stride * layer.outputs), 0.0f);
    for (int j = 0; j <= layer.inputs; ++j) {
      const float* column = weights.data() + layer.offset + j * layer.stride;
      for (int i = 0; i < layer.outputs; ++i) transposed_[l][static_cast<std::size_t>(i * stride + j)] = column[i];
    }
  }
}

// From the errors of layer l to those of layer l − 1.
void Perceptron::backward_step(std::size_t l, Eigen::Index count) {
  const auto& layer = shape_.layers()[l];
  const int stride = padded(layer.inputs + 1);
  Columns& before = errors_[l - 1];
  product(stride, transposed_[l].data(), stride, {errors_[l].data.data(), 1, layer.stride}, layer.outputs, count,
          before.data.data(), stride);
  Eigen::Map<const Eigen::ArrayXf, Eigen::AlignedMax> y(values_[l - 1].data.data(), stride * count);
  Eigen::Map<Eigen::ArrayXf, Eigen::AlignedMax> error(before.data.data(), stride * count);
  error *= 1 - y.square();
}

double Perceptron::cost(const Floats& weights, const Columns& inputs, const Columns& targets, Eigen::Index begin,
                        Eigen::Index count, Cost cost, Floats& gradient) {
  forward(weights, inputs, begin, count);
  const double sum = output_errors(targets, begin, count, cost);
  transpose(weights);
  for (std::size_t l = shape_.layers().size(); l-- > 0;) {
    const auto& layer = shape_.layers()[l];
    const float* x = l == 0 ? inputs_ : values_[l - 1].data.data();
    const int x_stride = l == 0 ? input_stride_ : values_[l - 1].stride;
    product(layer.stride, errors_[l].data.data(), layer.stride, {x, x_stride, 1}, count, layer.inputs + 1,
            gradient.data() + layer.offset, layer.stride);
    if (l > 0) backward_step(l, count);
  }
  return sum;
}

void Perceptron::jacobian(const Floats& weights, const Columns& inputs, const Columns& targets, Eigen::Index begin,
                          Eigen::Index count, Eigen::MatrixXf& rows, Eigen::MatrixXf& errors) {
  forward(weights, inputs, begin, count);
  output_errors(targets, begin, count, Cost::square);
  transpose(weights);
  const auto& layers = shape_.layers();
  const int outputs = layers.back().outputs;
  errors.resize(outputs, count);
  for (Eigen::Index s = 0; s < count; ++s) {
    for (int o = 0; o < outputs; ++o) errors(o, s) = errors_.back()[s][o];
  }
  rows.resize(outputs * count, shape_.weights());
  for (int o = 0; o < outputs; ++o) {
    for (Eigen::Index s = 0; s < count; ++s) {
      std::fill_n(errors_.back()[s], errors_.back().stride, 0.0f);
      errors_.back()[s][o] = 1;
    }
    for (std::size_t l = layers.size(); l-- > 1;) backward_step(l, count);
    Eigen::Index place = 0;
    for (std::size_t l = 0; l < layers.size(); ++l) {
      for (int j = 0; j <= layers[l].inputs; ++j) {
        for (int i = 0; i < layers[l].outputs; ++i, ++place) {
          for (Eigen::Index s = 0; s < count; ++s) {
            const float x = l == 0 ? inputs_[s * input_stride_ + j] : values_[l - 1][s][j];
            rows(o * count + s, place) = errors_[l][s][i] * x;
          }
        }
      }
    }
  }
}

Network network_of(const Shape& shape, const Floats& weights, const Eigen::VectorXd& mean,
                   const Eigen::VectorXd& deviation) {
  Network network;
  for (const auto& layer : shape.layers()) {
    Layer dense;
    dense.weights.resize(layer.outputs, layer.inputs);
    dense.bias.resize(layer.outputs);
    for (int i = 0; i < layer.outputs; ++i) {
      const float* row = weights.data() + layer.offset + i;
      for (int j = 0; j < layer.inputs; ++j) dense.weights(i, j) = static_cast<double>(row[j * layer.stride]);
      dense.bias[i] = static_cast<double>(row[layer.inputs * layer.stride]);
    }
    dense.activation = &layer == &shape.layers().back() ? Activation::identity : Activation::tanh;
    network.layers.push_back(std::move(dense));
  }
  contact_nn::Layer& first = network.layers.front();
  first.weights = first.weights * deviation.cwiseInverse().asDiagonal();
  first.bias -= first.weights * mean;
  return network;
}

}  // namespace quayside::contact_nn::paper
