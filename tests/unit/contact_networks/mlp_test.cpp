#include "contact_nn/mlp.h"

#include <gtest/gtest.h>

#include "contact_nn/training.h"
#include "tests/unit/contact_networks/heap_counter.h"

namespace quayside::contact_nn {
namespace {

// One network in both forms: they must say the same but for the rounding of some hundred sums of terms of order 1.
template <class Scalar, Activation hidden, int... sizes>
void expect_same(double tolerance) {
  const Network network = random_network({sizes...}, hidden, 7);
  const Mlp<Scalar, hidden, sizes...> mlp(network);
  const Eigen::MatrixXd inputs = Eigen::MatrixXd::Random(network.inputs(), 20);
  const Eigen::MatrixXd expected = network(inputs);
  for (int i = 0; i < inputs.cols(); ++i) {
    const Eigen::MatrixXd outputs = mlp(inputs.col(i).template cast<Scalar>()).template cast<double>();
    EXPECT_LT((outputs - expected.col(i)).cwiseAbs().maxCoeff(), tolerance) << mlp.architecture();
  }
}

TEST(Mlp, SaysWhatTheNetworkSays) {
  expect_same<double, Activation::tanh, 6, 20, 18, 4>(1e-14);
  expect_same<float, Activation::tanh, 6, 20, 18, 4>(1e-5);
  expect_same<float, Activation::relu, 36, 32, 24>(1e-5);
  expect_same<double, Activation::relu, 5, 3>(1e-14);  // one layer: linear
  // Sizes around the width of a vector, where a row too many or too few would show.
  expect_same<float, Activation::relu, 1, 1, 1>(1e-5);
  expect_same<float, Activation::relu, 3, 15, 17, 16, 2>(1e-5);
  expect_same<double, Activation::relu, 9, 129, 7>(1e-13);
}

TEST(Mlp, DoesNotTouchTheHeap) {
  const Mlp<float, Activation::tanh, 36, 32, 32, 72> mlp(random_network({36, 32, 32, 72}, Activation::tanh, 1));
  Eigen::Matrix<float, 36, 1> input = Eigen::Matrix<float, 36, 1>::Ones();
  const std::size_t before = heap_requests();
  for (int i = 0; i < 100; ++i) input[0] = mlp(input)[71];
  EXPECT_EQ(heap_requests(), before);

  const Eigen::MatrixXd proof = Eigen::MatrixXd::Zero(3, 3);  // the counter does count
  EXPECT_GT(heap_requests(), before);
  EXPECT_EQ(proof.sum(), 0);
}

TEST(Mlp, RefusesANetworkOfAnotherShape) {
  using Small = Mlp<float, Activation::tanh, 6, 20, 4>;
  EXPECT_NO_THROW(Small(random_network({6, 20, 4}, Activation::tanh, 1)));
  EXPECT_THROW(Small(random_network({6, 21, 4}, Activation::tanh, 1)), std::runtime_error);
  EXPECT_THROW(Small(random_network({6, 20, 20, 4}, Activation::tanh, 1)), std::runtime_error);
  EXPECT_THROW(Small(random_network({6, 20, 4}, Activation::relu, 1)), std::runtime_error);
  EXPECT_THROW(Small(Network{}), std::runtime_error);
  try {
    Small(random_network({6, 21, 4}, Activation::relu, 1));
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "the network is 6x21x4 relu, but 6x20x4 tanh is needed");
  }
}

}  // namespace
}  // namespace quayside::contact_nn
