#pragma once

#include <filesystem>
#include <string>

#include "tools/policy/mlp.h"

namespace koboshi::tools {

// Returns whether this build can read ONNX (libonnx-dev and libprotobuf-dev).
[[nodiscard]] bool reads_onnx();

// Reads a multilayer perceptron from an ONNX file: the nodes from its only input to the output of this name,
// by default the first. Gemm, MatMul, Add, Relu, Elu, Tanh, Sigmoid times its input, Sub, Div, Mul, Clip,
// Slice, Split, Constant and Identity; all other nodes on the way are named in the error. Throws InputError.
[[nodiscard]] Mlp read_onnx(const std::filesystem::path& file, const std::string& output = {});

}  // namespace koboshi::tools
