#include "contact_nn/onnx_file.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <onnx/onnx_pb.h>

#include "contact_nn/training.h"

namespace quayside::contact_nn {
namespace {

NetworkFile some_file(bool single = true) {
  NetworkFile file;
  file.network = random_network({6, 20, 18, 4}, Activation::tanh, 11);
  for (Layer& layer : file.network.layers) {
    layer.bias.setLinSpaced(-1, 1);
    if (!single) continue;
    layer.weights = layer.weights.cast<float>().cast<double>();
    layer.bias = layer.bias.cast<float>().cast<double>();
  }
  file.interface = "test/1";
  file.how_made = {{"seed", "11"}, {"data", "none – 20 µm"}};
  file.golden_inputs = Eigen::MatrixXd::Random(6, 3);
  return file;
}

std::string refusal(const std::string& bytes, const std::string& interface = "test/1") {
  try {
    network_from_bytes(bytes, interface, "some.onnx");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void expect_equal(const Network& a, const Network& b) {
  ASSERT_EQ(a.architecture(), b.architecture());
  for (std::size_t i = 0; i < a.layers.size(); ++i) {
    EXPECT_EQ(a.layers[i].weights, b.layers[i].weights);
    EXPECT_EQ(a.layers[i].bias, b.layers[i].bias);
    EXPECT_EQ(a.layers[i].activation, b.layers[i].activation);
  }
}

TEST(OnnxFile, WhatIsWrittenIsReadBackToTheLastBit) {
  for (const bool single : {true, false}) {
    const NetworkFile file = some_file(single);
    const NetworkFile back = network_from_bytes(network_bytes(file), "test/1", "memory");
    expect_equal(back.network, file.network);
    EXPECT_EQ(back.how_made.at("seed"), "11");
    EXPECT_EQ(back.how_made.at("data"), "none – 20 µm");
    EXPECT_EQ(back.golden_inputs, file.golden_inputs);
    EXPECT_EQ(network_bytes(back), network_bytes(file));
  }
}

TEST(OnnxFile, SinglePrecisionWeightsTakeFourBytes) {
  EXPECT_LT(network_bytes(some_file(true)).size() + 4 * (6 * 20 + 20 * 18 + 18 * 4), network_bytes(some_file(false)).size() + 100);
}

TEST(OnnxFile, GoesThroughAFile) {
  const std::string path = testing::TempDir() + "network_round_trip.onnx";
  write_network(path, some_file());
  expect_equal(read_network(path, "test/1").network, some_file().network);
  std::filesystem::remove(path);
  EXPECT_THROW(write_network("/no/such/folder/n.onnx", some_file()), std::runtime_error);
}

TEST(OnnxFile, RefusesWhatIsNoNetworkFile) {
  EXPECT_TRUE(contains(refusal(""), "not an ONNX file"));
  EXPECT_TRUE(contains(refusal("\x89PNG\r\n\x1a\n and so on"), "not an ONNX file"));
  EXPECT_TRUE(contains(refusal("title: Land a container\nduration: 30\n"), "not an ONNX file"));
  EXPECT_TRUE(contains(refusal(network_bytes(some_file()), "other/2"), "made for 'test/1', but 'other/2' is needed"));
  EXPECT_THROW(read_network("/no/such/file.onnx", "test/1"), std::runtime_error);
  EXPECT_THROW(read_network(testing::TempDir(), "test/1"), std::runtime_error);
  EXPECT_TRUE(contains(refusal("x"), "some.onnx"));  // the message names the file
}

TEST(OnnxFile, RefusesAFileThatWasCutOff) {
  const std::string bytes = network_bytes(some_file());
  for (std::size_t size = 0; size < bytes.size(); size += 7) EXPECT_NE(refusal(bytes.substr(0, size)), "") << size;
}

// A flipped bit may hit a text that says how the network was made, or a name. What it must never do is change what the
// network says.
TEST(OnnxFile, NoFlippedBitChangesTheNetworkUnseen) {
  const NetworkFile file = some_file();
  const std::string bytes = network_bytes(file);
  int refused = 0, tried = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << (i % 8)));
    ++tried;
    try {
      expect_equal(network_from_bytes(damaged, "test/1", "damaged").network, file.network);
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, tried / 2);  // more than half of the file are weights
}

// A network from elsewhere, as other tools write it: MatMul and Add, weights listed one number at a time, an Identity
// at the end, no checksum.
onnx::ModelProto foreign_model(float weight = 2) {
  onnx::ModelProto model;
  model.set_ir_version(7);
  model.add_opset_import()->set_version(11);
  auto& graph = *model.mutable_graph();
  graph.add_input()->set_name("x");
  graph.add_output()->set_name("y");
  auto& w = *graph.add_initializer();
  w.set_name("w");
  w.set_data_type(onnx::TensorProto::FLOAT);
  for (int n : {2, 1}) w.add_dims(n);  // inputs × outputs
  for (float x : {weight, 3.0f}) w.add_float_data(x);
  auto& b = *graph.add_initializer();
  b.set_name("b");
  b.set_data_type(onnx::TensorProto::DOUBLE);
  b.add_dims(1);
  b.add_double_data(0.5);
  const auto node = [&](const char* kind, std::vector<const char*> inputs, const char* output) {
    auto& n = *graph.add_node();
    n.set_op_type(kind);
    for (const char* input : inputs) n.add_input(input);
    n.add_output(output);
  };
  node("MatMul", {"x", "w"}, "m");
  node("Add", {"m", "b"}, "s");
  node("Identity", {"s"}, "y");
  const auto property = [&](const char* key, const char* value) {
    auto& p = *model.add_metadata_props();
    p.set_key(key);
    p.set_value(value);
  };
  property("interface", "test/1");
  property("golden_inputs", "2 1: 1 10");
  property("golden_outputs", "1 1: 32.5");  // 2 · 1 + 3 · 10 + 0.5
  return model;
}

TEST(OnnxFile, ReadsANetworkFromElsewhere) {
  const NetworkFile file = network_from_bytes(foreign_model().SerializeAsString(), "test/1", "foreign");
  ASSERT_EQ(file.network.architecture(), "2x1 identity");
  EXPECT_EQ(file.network(Eigen::Vector2d(1, 1))(0, 0), 5.5);
}

TEST(OnnxFile, ChecksGoldenPairs) {
  const std::string message = refusal(foreign_model(2.1f).SerializeAsString());
  EXPECT_TRUE(contains(message, "golden outputs are missed by 0.1")) << message;
}

TEST(OnnxFile, SaysWhatIsMissingOrUnknown) {
  onnx::ModelProto model = foreign_model();
  model.clear_metadata_props();
  EXPECT_TRUE(contains(refusal(model.SerializeAsString()), "metadata lack 'interface'"));
  model = foreign_model();
  model.mutable_graph()->mutable_node(2)->set_op_type("Conv");
  EXPECT_TRUE(contains(refusal(model.SerializeAsString()), "node Conv is not one of"));
  model = foreign_model();
  model.mutable_graph()->mutable_initializer(0)->set_dims(0, 5);
  EXPECT_TRUE(contains(refusal(model.SerializeAsString()), "holds 2 numbers instead of 5"));
  model = foreign_model();
  model.mutable_graph()->mutable_initializer(0)->set_float_data(0, std::numeric_limits<float>::infinity());
  EXPECT_TRUE(contains(refusal(model.SerializeAsString()), "not finite"));
}

}  // namespace
}  // namespace quayside::contact_nn
