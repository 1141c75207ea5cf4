# SPDX-License-Identifier: LGPL-2.1-or-later
"""Weights of convolutions from a TensorFlow Lite file (schema.fbs, version 3), 8-bit ones as real numbers."""
import flatbuffers.number_types as numbers
import numpy as np
import torch
from flatbuffers import encode, table

CONVOLUTION, DEPTHWISE = 3, 4  # BuiltinOperator
TYPES = {0: np.float32, 2: np.int32, 3: np.uint8, 9: np.int8}


class Table:
    """Fields by their number in the schema."""

    def __init__(self, data, position):
        self.data, self.table = data, table.Table(data, position)

    def number(self, field, kind, default=0):
        at = self.table.Offset(4 + 2 * field)
        return self.table.Get(kind, at + self.table.Pos) if at else default

    def one(self, field):
        at = self.table.Offset(4 + 2 * field)
        return Table(self.data, self.table.Indirect(at + self.table.Pos)) if at else None

    def tables(self, field):
        at = self.table.Offset(4 + 2 * field)
        start = self.table.Vector(at)
        return [Table(self.data, self.table.Indirect(start + 4 * k)) for k in range(self.table.VectorLen(at))]

    def array(self, field, kind):
        at = self.table.Offset(4 + 2 * field)
        count = self.table.VectorLen(at) if at else 0
        return np.frombuffer(self.data, kind, count, self.table.Vector(at)) if count else np.empty(0, kind)


def real(tensor, buffers):
    """A constant tensor; its raw bytes are in a buffer."""
    data = buffers[tensor.number(2, numbers.Uint32Flags)].array(0, np.uint8)
    values = np.frombuffer(data.tobytes(), TYPES[tensor.number(1, numbers.Int8Flags)]).reshape(tensor.array(0, np.int32))
    quantization = tensor.one(4)
    scale, zero = (quantization.array(2, np.float32), quantization.array(3, np.int64)) if quantization else ((), ())
    if len(scale) > 1:
        raise ValueError("weights with a scale for each channel are not supported")
    return (values.astype(np.float64) - zero[0]) * scale[0] if len(scale) else values


def convolutions(path):
    """(weight, bias) of each convolution as PyTorch has them, in order of execution."""
    with open(path, "rb") as file:
        data = bytearray(file.read())
    model = Table(data, encode.Get(numbers.UOffsetTFlags.packer_type, data, 0))
    codes = [max(c.number(0, numbers.Int8Flags), c.number(3, numbers.Int32Flags)) for c in model.tables(1)]
    graph, buffers = model.tables(2)[0], model.tables(4)
    tensors, found = graph.tables(0), []
    for operator in graph.tables(3):
        code = codes[operator.number(0, numbers.Uint32Flags)]
        if code in (CONVOLUTION, DEPTHWISE):
            weight, bias = (real(tensors[k], buffers) for k in operator.array(1, np.int32)[1:3])
            order = (0, 3, 1, 2) if code == CONVOLUTION else (3, 0, 1, 2)
            found.append((torch.from_numpy(weight.transpose(order).copy()), torch.from_numpy(bias.reshape(-1).copy())))
    return found
