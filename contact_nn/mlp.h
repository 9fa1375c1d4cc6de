// Multilayer perceptrons, in two forms: `Network`, whose sizes are known at run time, for training and files;
// and `Mlp`, whose sizes are template arguments, for the step path.
#pragma once

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace quayside::contact_nn {

enum class Activation { identity, tanh, relu };

// y = activation(weights x + bias)
struct Layer {
  Eigen::MatrixXd weights;  // outputs × inputs
  Eigen::VectorXd bias;     // outputs
  Activation activation = Activation::identity;
};

// A network of dense layers; the last one is linear, as in the paper.
struct Network {
  std::vector<Layer> layers;

  int inputs() const { return layers.empty() ? 0 : static_cast<int>(layers.front().weights.cols()); }
  int outputs() const { return layers.empty() ? 0 : static_cast<int>(layers.back().weights.rows()); }
  std::string architecture() const;  // e.g. "6x20x18x4 tanh"

  // One column per sample, in and out.
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& inputs) const;
};

Eigen::MatrixXd activated(Activation activation, const Eigen::MatrixXd& sums);

namespace detail {

// The widest vector that the compiler was told to use. Mixing widths between translation units would break the
// layout of `Mlp`, as it would Eigen's: all are compiled with the same flags.
#if defined(__AVX512F__)
inline constexpr std::size_t vector_bytes = 64;
#elif defined(__AVX__)
inline constexpr std::size_t vector_bytes = 32;
#else
inline constexpr std::size_t vector_bytes = 16;
#endif

template <class Scalar>
struct VectorOf {
  typedef Scalar type __attribute__((vector_size(vector_bytes), may_alias));
  static constexpr int lanes = vector_bytes / sizeof(Scalar);
};

// Outputs are computed a vector of rows at a time, all accumulators in registers. Columns go to `chains`
// independent sums, since one fused multiply-add must else wait for the one before it.
template <class Scalar, int Inputs, int Outputs, Activation activation>
class DenseLayer {
  using Vector = typename VectorOf<Scalar>::type;
  static constexpr int lanes = VectorOf<Scalar>::lanes;
  static constexpr int blocks = (Outputs + lanes - 1) / lanes;
  static constexpr int chains = blocks >= 8 ? 1 : blocks >= 4 ? 2 : 4;

 public:
  static constexpr int padded_outputs = blocks * lanes;

  void set(const Layer& layer) {
    for (int block = 0; block < blocks; ++block) {
      for (int lane = 0; lane < lanes; ++lane) {
        const int row = block * lanes + lane;
        const bool real = row < Outputs;
        bias_[block][lane] = real ? static_cast<Scalar>(layer.bias(row)) : Scalar(0);
        for (int column = 0; column < Inputs; ++column) {
          weights_[column * blocks + block][lane] = real ? static_cast<Scalar>(layer.weights(row, column)) : Scalar(0);
        }
      }
    }
  }

  // `inputs` holds `Inputs` numbers, `outputs` room for `padded_outputs`, aligned to `vector_bytes`.
  void operator()(const Scalar* inputs, Scalar* outputs) const {
    Vector sums[chains][blocks];
    for (int block = 0; block < blocks; ++block) sums[0][block] = bias_[block];
    for (int chain = 1; chain < chains; ++chain) {
      for (int block = 0; block < blocks; ++block) sums[chain][block] = Vector{};
    }
    constexpr int whole = Inputs / chains * chains;
    for (int column = 0; column < whole; column += chains) {
#pragma GCC unroll 4
      for (int chain = 0; chain < chains; ++chain) {
        const Scalar x = inputs[column + chain];
#pragma GCC unroll 16
        for (int block = 0; block < blocks; ++block) {
          sums[chain][block] += weights_[(column + chain) * blocks + block] * x;
        }
      }
    }
    for (int column = whole; column < Inputs; ++column) {
      for (int block = 0; block < blocks; ++block) sums[0][block] += weights_[column * blocks + block] * inputs[column];
    }
    for (int block = 0; block < blocks; ++block) {
      Vector sum = sums[0][block];
      for (int chain = 1; chain < chains; ++chain) sum += sums[chain][block];
      if constexpr (activation == Activation::relu) sum = sum > Scalar(0) ? sum : Vector{};
      *reinterpret_cast<Vector*>(outputs + block * lanes) = sum;
    }
    if constexpr (activation == Activation::tanh) {
      Eigen::Map<Eigen::Array<Scalar, padded_outputs, 1>, Eigen::AlignedMax> y(outputs);
      y = y.tanh();
    }
  }

 private:
  Vector weights_[static_cast<std::size_t>(Inputs) * blocks];
  Vector bias_[blocks];
};

}  // namespace detail

// A network whose sizes are `First, Rest...`, hidden layers activated by `hidden`, the last one linear. The forward
// path neither allocates nor locks.
template <class Scalar, Activation hidden, int First, int... Rest>
class Mlp {
  static_assert(sizeof...(Rest) >= 1, "a network has at least one layer");
  static constexpr std::array<int, sizeof...(Rest) + 1> sizes{First, Rest...};
  static constexpr std::size_t count = sizeof...(Rest);

 public:
  static constexpr int inputs = First;
  static constexpr int outputs = sizes.back();
  using Input = Eigen::Matrix<Scalar, inputs, 1>;
  using Output = Eigen::Matrix<Scalar, outputs, 1>;

  // Throws std::runtime_error when the network has other sizes or another activation.
  explicit Mlp(const Network& network) {
    if (!fits(network)) {
      throw std::runtime_error("the network is " + network.architecture() + ", but " + architecture() + " is needed");
    }
    set(network, std::make_index_sequence<count>());
  }

  Output operator()(const Input& input) const {
    alignas(detail::vector_bytes) Scalar buffers[2][widest()];
    forward(input.data(), buffers, std::make_index_sequence<count>());
    return Eigen::Map<const Output>(buffers[(count - 1) % 2]);
  }

  static std::vector<int> layer_sizes() { return {sizes.begin(), sizes.end()}; }

  static std::string architecture() {
    std::string text = std::to_string(First);
    for (std::size_t i = 1; i < sizes.size(); ++i) text += "x" + std::to_string(sizes[i]);
    return text + (hidden == Activation::tanh ? " tanh" : hidden == Activation::relu ? " relu" : " identity");
  }

 private:
  static constexpr Activation activation_of(std::size_t layer) {
    return layer + 1 < count ? hidden : Activation::identity;
  }

  template <std::size_t i>
  using LayerAt = detail::DenseLayer<Scalar, sizes[i], sizes[i + 1], activation_of(i)>;

  template <std::size_t... i>
  static std::tuple<LayerAt<i>...> layers_type(std::index_sequence<i...>);
  using Layers = decltype(layers_type(std::make_index_sequence<count>()));

  static constexpr int widest() {
    int size = 0;
    for (int n : sizes) size = n > size ? n : size;
    constexpr int lanes = detail::VectorOf<Scalar>::lanes;
    return (size + lanes - 1) / lanes * lanes;
  }

  static bool fits(const Network& network) {
    if (network.layers.size() != count) return false;
    for (std::size_t i = 0; i < count; ++i) {
      const Layer& layer = network.layers[i];
      if (layer.weights.cols() != sizes[i] || layer.weights.rows() != sizes[i + 1]) return false;
      if (layer.activation != activation_of(i)) return false;
    }
    return true;
  }

  template <std::size_t... i>
  void set(const Network& network, std::index_sequence<i...>) {
    (std::get<i>(layers_).set(network.layers[i]), ...);
  }

  // Layer i reads what layer i − 1 wrote into the other buffer.
  template <std::size_t... i>
  void forward(const Scalar* input, Scalar (*buffers)[widest()], std::index_sequence<i...>) const {
    (std::get<i>(layers_)(i == 0 ? input : buffers[(i + 1) % 2], buffers[i % 2]), ...);
  }

  Layers layers_;
};

}  // namespace quayside::contact_nn
