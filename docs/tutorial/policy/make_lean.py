#!/usr/bin/python3
"""Writes lean.onnx: a network whose weights are set by hand, to approximate a feedback of roll and pitch by tanh.

Usage: make_lean.py lean.onnx

It has the nodes that exporters write: the normaliser's Sub, Div and Clip, Gemm, Tanh, Gemm. The messages are those of onnx.proto;
the few fields that it needs are encoded here, so that no package is needed.
"""

import struct
import sys

FLOAT = 1
INPUTS = 4  # roll, roll rate, pitch, pitch rate
DEVIATION = (0.03, 0.4, 0.03, 0.4)
HIDDEN = 16
# rad of offset per unit of the normalised inputs: ankle roll, ankle pitch
GAINS = ((0.004, 0.010, 0.0, 0.0), (0.0, 0.0, 0.004, 0.008))


def varint(number):
    out = b""
    while number > 127:
        out, number = out + bytes([number & 127 | 128]), number >> 7
    return out + bytes([number])


def field(number, value):
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    data = value.encode() if isinstance(value, str) else value
    return varint(number << 3 | 2) + varint(len(data)) + data


def tensor(name, shape, values):
    return (b"".join(field(1, size) for size in shape) + field(2, FLOAT) + field(8, name) +
            field(9, struct.pack(f"<{len(values)}f", *values)))


def node(kind, inputs, output, **attributes):
    message = b"".join(field(1, name) for name in inputs) + field(2, output) + field(4, kind)
    for name, value in attributes.items():
        message += field(5, field(1, name) + field(3, value) + field(20, 2))
    return message


def value_info(name, size):
    shape = field(1, field(1, 1)) + field(1, field(1, size))
    return field(1, name) + field(2, field(1, field(1, FLOAT) + field(2, shape)))


def network():
    first, second = [0.0] * (HIDDEN * INPUTS), [0.0] * (4 * HIDDEN)
    for neuron in range(HIDDEN):
        axis, slope = neuron % 2, 0.2 + 0.1 * (neuron // 2)  # a sum of tanh of several slopes is nearly straight
        for i in range(INPUTS):
            first[neuron * INPUTS + i] = slope * GAINS[axis][i] / 0.01
        for output in ((0, 1) if axis == 0 else (2, 3)):
            second[output * HIDDEN + neuron] = 0.01 / slope / (HIDDEN / 2)
    constants = [tensor("mean", (INPUTS,), [0.0] * INPUTS), tensor("deviation", (INPUTS,), DEVIATION), tensor("low", (), [-5.0]),
                 tensor("high", (), [5.0]), tensor("w0", (HIDDEN, INPUTS), first), tensor("b0", (HIDDEN,), [0.0] * HIDDEN),
                 tensor("w1", (4, HIDDEN), second), tensor("b1", (4,), [0.0] * 4)]
    nodes = [node("Sub", ("obs", "mean"), "centred"), node("Div", ("centred", "deviation"), "scaled"),
             node("Clip", ("scaled", "low", "high"), "normalised"), node("Gemm", ("normalised", "w0", "b0"), "sums", transB=1),
             node("Tanh", ("sums",), "hidden"), node("Gemm", ("hidden", "w1", "b1"), "actions", transB=1)]
    return (b"".join(field(1, each) for each in nodes) + field(2, "lean") + b"".join(field(5, each) for each in constants) +
            field(11, value_info("obs", INPUTS)) + field(12, value_info("actions", 4)))


def main():
    model = field(1, 8) + field(2, "make_lean.py") + field(7, network()) + field(8, field(1, "") + field(2, 17))
    with open(sys.argv[1], "wb") as file:
        file.write(model)


if __name__ == "__main__":
    main()
