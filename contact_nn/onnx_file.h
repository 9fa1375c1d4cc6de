// Network files: ONNX, so that a network can be trained elsewhere and looked at with common tools.
//
// The graph is a chain of dense layers (Gemm, or MatMul and Add) and activations (Tanh, Relu) with one input and one
// output, `[samples, size]`. The model's metadata properties tell what the file is for and how it was made:
//
//   interface        what goes in and comes out, e.g. "gate_potential/1": must be the one that the caller needs
//   golden_inputs,   a few samples, "rows columns: numbers" row by row; checked when the file is read, so that a
//   golden_outputs   network that lost a weight on the way is not used
//   checksum         of all weights; optional, for files made elsewhere
//   anything else    for people: data, seed, optimiser, errors, shares
#pragma once

#include <map>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "contact_nn/mlp.h"

namespace quayside::contact_nn {

struct NetworkFile {
  Network network;
  std::string interface;
  std::map<std::string, std::string> how_made;
  Eigen::MatrixXd golden_inputs;   // one column per sample
  Eigen::MatrixXd golden_outputs;  // what the network said to them when it was written
};

// The bytes of the file; golden outputs are computed here. Weights are stored in single precision where that loses
// nothing. The same content gives the same bytes. Throws std::invalid_argument when there are no golden inputs.
std::string network_bytes(const NetworkFile& file);

// Throws std::runtime_error when the bytes are not such a network, or one of another interface, or when its golden
// outputs do not come out. `name` stands for the file in the message.
NetworkFile network_from_bytes(std::string_view bytes, const std::string& interface, const std::string& name);

// The same with files. Throw std::runtime_error when the file cannot be written or read as well.
void write_network(const std::string& path, const NetworkFile& file);
NetworkFile read_network(const std::string& path, const std::string& interface);

}  // namespace quayside::contact_nn
