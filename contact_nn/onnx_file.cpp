#include "contact_nn/onnx_file.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <onnx/onnx_pb.h>

namespace quayside::contact_nn {

namespace {

// Layers are summed in another order by whoever wrote the file, in single precision at worst: 1e-7 per operation,
// some hundred operations, relative to the largest output.
constexpr double golden_tolerance = 1e-5;

// Networks here have some ten thousand weights; a file beyond this is something else.
constexpr std::uintmax_t largest_file = 64u << 20;  // bytes

constexpr int opset = 13;
constexpr int ir_version = 8;

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw std::runtime_error(fmt::format("network {}: {}", name, why));
}

bool fits_single(const Eigen::MatrixXd& m) { return m.cast<float>().cast<double>() == m; }

// Fowler, Noll and Vo, FNV-1a, over the weights as doubles, layer by layer.
std::string checksum_of(const Network& network) {
  std::uint64_t hash = 14695981039346656037u;
  const auto add = [&hash](const auto& numbers) {
    for (const double number : numbers.reshaped()) {
      unsigned char bytes[sizeof number];
      std::memcpy(bytes, &number, sizeof number);
      for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211u;
    }
  };
  for (const Layer& layer : network.layers) {
    add(layer.weights);
    add(layer.bias);
  }
  return fmt::format("{:016x}", hash);
}

std::string text_of(const Eigen::MatrixXd& m) {
  std::string text = fmt::format("{} {}:", m.rows(), m.cols());
  for (Eigen::Index row = 0; row < m.rows(); ++row) {
    for (Eigen::Index column = 0; column < m.cols(); ++column) text += fmt::format(" {}", m(row, column));
  }
  return text;
}

Eigen::MatrixXd matrix_of(const std::string& text, const std::string& key, const std::string& name) {
  std::istringstream in(text);
  Eigen::Index rows = 0, columns = 0;
  char colon = 0;
  if (!(in >> rows >> columns >> colon) || colon != ':' || rows < 1 || columns < 1 || rows > 10000 || columns > 10000) {
    refuse(name, "its metadata '" + key + "' does not begin with 'rows columns:'");
  }
  Eigen::MatrixXd m(rows, columns);
  for (Eigen::Index row = 0; row < rows; ++row) {
    for (Eigen::Index column = 0; column < columns; ++column) {
      if (!(in >> m(row, column))) refuse(name, "its metadata '" + key + "' has too few numbers");
    }
  }
  return m;
}

void add_tensor(onnx::GraphProto& graph, const std::string& name, const Eigen::MatrixXd& m, bool vector, bool single) {
  onnx::TensorProto& tensor = *graph.add_initializer();
  tensor.set_name(name);
  tensor.add_dims(m.rows());
  if (!vector) tensor.add_dims(m.cols());
  tensor.set_data_type(single ? onnx::TensorProto::FLOAT : onnx::TensorProto::DOUBLE);
  std::string& bytes = *tensor.mutable_raw_data();
  for (Eigen::Index row = 0; row < m.rows(); ++row) {
    for (Eigen::Index column = 0; column < m.cols(); ++column) {
      const double number = m(row, column);
      const float short_number = static_cast<float>(number);
      if (single) {
        bytes.append(reinterpret_cast<const char*>(&short_number), sizeof short_number);
      } else {
        bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
      }
    }
  }
}

void set_type(onnx::ValueInfoProto& value, const std::string& name, int size, bool single) {
  value.set_name(name);
  auto& type = *value.mutable_type()->mutable_tensor_type();
  type.set_elem_type(single ? onnx::TensorProto::FLOAT : onnx::TensorProto::DOUBLE);
  type.mutable_shape()->add_dim()->set_dim_param("samples");
  type.mutable_shape()->add_dim()->set_dim_value(size);
}

void add_property(onnx::ModelProto& model, const std::string& key, const std::string& value) {
  auto& property = *model.add_metadata_props();
  property.set_key(key);
  property.set_value(value);
}

// A matrix, or a vector as one column.
Eigen::MatrixXd tensor_of(const onnx::TensorProto& tensor, const std::string& name) {
  if (tensor.dims_size() < 1 || tensor.dims_size() > 2) {
    refuse(name, fmt::format("tensor '{}' is neither a matrix nor a vector", tensor.name()));
  }
  const std::int64_t rows = tensor.dims(0), columns = tensor.dims_size() == 2 ? tensor.dims(1) : 1;
  if (rows < 1 || columns < 1 || rows > 100000 || columns > 100000) {
    refuse(name, fmt::format("tensor '{}' has the impossible size {} × {}", tensor.name(), rows, columns));
  }
  const bool single = tensor.data_type() == onnx::TensorProto::FLOAT;
  if (!single && tensor.data_type() != onnx::TensorProto::DOUBLE) {
    refuse(name, fmt::format("tensor '{}' is neither float nor double", tensor.name()));
  }
  const std::size_t count = static_cast<std::size_t>(rows * columns), width = single ? sizeof(float) : sizeof(double);
  const std::string& raw = tensor.raw_data();
  const std::size_t stored = !raw.empty() ? raw.size() / width
                             : single     ? static_cast<std::size_t>(tensor.float_data_size())
                                          : static_cast<std::size_t>(tensor.double_data_size());
  if (stored != count || raw.size() % width != 0) {
    refuse(name, fmt::format("tensor '{}' holds {} numbers instead of {}", tensor.name(), stored, count));
  }
  Eigen::MatrixXd m(rows, columns);
  for (std::size_t i = 0; i < count; ++i) {
    double number;
    if (raw.empty()) {
      number = single ? tensor.float_data(static_cast<int>(i)) : tensor.double_data(static_cast<int>(i));
    } else if (single) {
      float short_number;
      std::memcpy(&short_number, raw.data() + i * width, width);
      number = short_number;
    } else {
      std::memcpy(&number, raw.data() + i * width, width);
    }
    m(static_cast<Eigen::Index>(i) / columns, static_cast<Eigen::Index>(i) % columns) = number;
  }
  if (!m.allFinite()) refuse(name, fmt::format("tensor '{}' holds numbers that are not finite", tensor.name()));
  return m;
}

double attribute(const onnx::NodeProto& node, const std::string& key, double standard) {
  for (const auto& a : node.attribute()) {
    if (a.name() == key) return a.type() == onnx::AttributeProto::INT ? static_cast<double>(a.i()) : a.f();
  }
  return standard;
}

// Follows the one chain from the graph's input to its output.
Network network_of(const onnx::GraphProto& graph, const std::string& name) {
  std::map<std::string, Eigen::MatrixXd> tensors;
  for (const auto& tensor : graph.initializer()) tensors[tensor.name()] = tensor_of(tensor, name);
  const auto constant = [&](const onnx::NodeProto& node, int input) -> const Eigen::MatrixXd& {
    const auto found = input < node.input_size() ? tensors.find(node.input(input)) : tensors.end();
    if (found == tensors.end()) refuse(name, fmt::format("node {} lacks its constant operand", node.op_type()));
    return found->second;
  };
  std::string value;
  for (const auto& input : graph.input()) {
    if (tensors.count(input.name())) continue;  // old files list their weights as inputs
    if (!value.empty()) refuse(name, "it has more than one input");
    value = input.name();
  }
  if (value.empty()) refuse(name, "it has no input");

  Network network;
  bool linear_so_far = false;  // may the next node be an Add or an activation?
  for (const auto& node : graph.node()) {
    const std::string& kind = node.op_type();
    if (node.input_size() < 1 || node.output_size() != 1 || node.input(0) != value) {
      refuse(name, fmt::format("node {} does not continue the chain of layers", kind));
    }
    value = node.output(0);
    if (kind == "Gemm" || kind == "MatMul") {
      Layer layer;
      layer.weights = constant(node, 1);
      if (kind == "MatMul" || attribute(node, "transB", 0) == 0) layer.weights.transposeInPlace();
      if (kind == "Gemm" && attribute(node, "transA", 0) != 0) refuse(name, "Gemm with transA is not a dense layer");
      layer.weights *= attribute(node, "alpha", 1);
      layer.bias = Eigen::VectorXd::Zero(layer.weights.rows());
      if (kind == "Gemm" && node.input_size() > 2) {
        const Eigen::MatrixXd& bias = constant(node, 2);
        if (bias.size() != layer.weights.rows()) refuse(name, "a bias has another size than its layer");
        layer.bias = attribute(node, "beta", 1) * bias.reshaped();
      }
      if (!network.layers.empty() && network.outputs() != layer.weights.cols()) {
        refuse(name, "the sizes of two layers do not fit together");
      }
      network.layers.push_back(std::move(layer));
      linear_so_far = true;
    } else if (kind == "Add" && linear_so_far) {
      const Eigen::MatrixXd& bias = constant(node, 1);
      if (bias.size() != network.outputs()) refuse(name, "a bias has another size than its layer");
      network.layers.back().bias += bias.reshaped();
    } else if ((kind == "Tanh" || kind == "Relu") && linear_so_far) {
      network.layers.back().activation = kind == "Tanh" ? Activation::tanh : Activation::relu;
      linear_so_far = false;
    } else if (kind != "Identity") {
      refuse(name, fmt::format("node {} is not one of Gemm, MatMul, Add, Tanh, Relu in the order of a dense network",
                               kind));
    }
  }
  if (network.layers.empty()) refuse(name, "it has no layers");
  if (graph.output_size() != 1 || graph.output(0).name() != value) refuse(name, "its output is not its last layer's");
  return network;
}

void check_golden(const NetworkFile& file, const std::string& name) {
  if (file.golden_inputs.rows() != file.network.inputs() || file.golden_outputs.rows() != file.network.outputs() ||
      file.golden_inputs.cols() != file.golden_outputs.cols()) {
    refuse(name, "its golden pairs have another size than the network");
  }
  const Eigen::MatrixXd outputs = file.network(file.golden_inputs);
  const double error = (outputs - file.golden_outputs).cwiseAbs().maxCoeff();
  const double size = 1 + file.golden_outputs.cwiseAbs().maxCoeff();
  if (!(error <= golden_tolerance * size)) {
    refuse(name, fmt::format("its golden outputs are missed by {:.2g}: the file is damaged, or was not written by the "
                             "network that it holds",
                             error));
  }
}

}  // namespace

std::string network_bytes(const NetworkFile& file) {
  if (file.golden_inputs.cols() < 1 || file.golden_inputs.rows() != file.network.inputs()) {
    throw std::invalid_argument("a network file needs golden inputs of the network's size");
  }
  bool single = true;
  for (const Layer& layer : file.network.layers) single &= fits_single(layer.weights) && fits_single(layer.bias);

  onnx::ModelProto model;
  model.set_ir_version(ir_version);
  model.set_producer_name("quayside");
  model.add_opset_import()->set_version(opset);
  onnx::GraphProto& graph = *model.mutable_graph();
  graph.set_name(file.interface);
  set_type(*graph.add_input(), "input", file.network.inputs(), single);
  set_type(*graph.add_output(), "output", file.network.outputs(), single);
  std::string value = "input";
  for (std::size_t i = 0; i < file.network.layers.size(); ++i) {
    const Layer& layer = file.network.layers[i];
    const bool last = i + 1 == file.network.layers.size(), linear = layer.activation == Activation::identity;
    const std::string weights = fmt::format("weights{}", i), bias = fmt::format("bias{}", i);
    add_tensor(graph, weights, layer.weights, false, single);
    add_tensor(graph, bias, layer.bias, true, single);
    onnx::NodeProto& gemm = *graph.add_node();
    gemm.set_op_type("Gemm");
    gemm.add_input(value);
    gemm.add_input(weights);
    gemm.add_input(bias);
    onnx::AttributeProto& transposed = *gemm.add_attribute();
    transposed.set_name("transB");
    transposed.set_type(onnx::AttributeProto::INT);
    transposed.set_i(1);
    value = last && linear ? "output" : fmt::format("sum{}", i);
    gemm.add_output(value);
    if (!linear) {
      onnx::NodeProto& node = *graph.add_node();
      node.set_op_type(layer.activation == Activation::tanh ? "Tanh" : "Relu");
      node.add_input(value);
      value = last ? "output" : fmt::format("hidden{}", i);
      node.add_output(value);
    }
  }
  add_property(model, "interface", file.interface);
  add_property(model, "architecture", file.network.architecture());
  for (const auto& [key, text] : file.how_made) {
    if (key != "interface" && key != "architecture" && key != "checksum" && key.rfind("golden_", 0) != 0) {
      add_property(model, key, text);
    }
  }
  add_property(model, "checksum", checksum_of(file.network));
  add_property(model, "golden_inputs", text_of(file.golden_inputs));
  add_property(model, "golden_outputs", text_of(file.network(file.golden_inputs)));
  return model.SerializeAsString();
}

NetworkFile network_from_bytes(std::string_view bytes, const std::string& interface, const std::string& name) {
  onnx::ModelProto model;
  if (bytes.empty() || !model.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) || !model.has_graph()) {
    refuse(name, "this is not an ONNX file, or it is cut off");
  }
  NetworkFile file;
  for (const auto& property : model.metadata_props()) file.how_made[property.key()] = property.value();
  const auto take = [&](const std::string& key) {
    const auto node = file.how_made.extract(key);
    if (node.empty()) {
      refuse(name, fmt::format("its metadata lack '{}'; a network for '{}' tells its interface and golden pairs", key,
                               interface));
    }
    return node.mapped();
  };
  file.interface = take("interface");
  if (file.interface != interface) {
    refuse(name, fmt::format("it is made for '{}', but '{}' is needed", file.interface, interface));
  }
  file.golden_inputs = matrix_of(take("golden_inputs"), "golden_inputs", name);
  file.golden_outputs = matrix_of(take("golden_outputs"), "golden_outputs", name);
  file.network = network_of(model.graph(), name);
  const auto checksum = file.how_made.extract("checksum");
  if (!checksum.empty() && checksum.mapped() != checksum_of(file.network)) {
    refuse(name, "its weights do not have the checksum that they were written with: the file is damaged");
  }
  check_golden(file, name);
  return file;
}

void write_network(const std::string& path, const NetworkFile& file) {
  const std::string bytes = network_bytes(file);
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) refuse(path, "cannot be written: does its folder exist, and may you write there?");
}

NetworkFile read_network(const std::string& path, const std::string& interface) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) refuse(path, "is a folder, not a file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) refuse(path, "cannot be read: " + error.message());
  if (size > largest_file) refuse(path, "is far too large to be a network of this kind");
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in) refuse(path, "cannot be read");
  return network_from_bytes(bytes, interface, path);
}

}  // namespace quayside::contact_nn
