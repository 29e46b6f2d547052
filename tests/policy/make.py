"""Write `to_the_exit.onnx`: a policy for `chase` that turns to the exit and drives, with some arbitrary terms.

    pip install onnx numpy
    python make.py
"""

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

OBSERVATION = 62  # `state`: own (7), one exit (5), five other robots (10 each)
BEARING = 7  # of the exit: ahead, left, cosine, sine, proximity


def main():
    random = np.random.default_rng(32)
    first = random.normal(0.0, 0.05, (6, OBSERVATION)).astype(np.float32)
    second = random.normal(0.0, 0.05, (2, 6)).astype(np.float32)
    first[0, BEARING + 2], second[0, 0] = 1.5, 1.0
    first[1, BEARING + 3], second[1, 1] = 1.5, 0.8
    constants = {"w1": first, "b1": np.zeros(6, np.float32), "w2": second, "b2": np.float32([0.2, 0.0])}
    nodes = [
        helper.make_node("Gemm", ["observation", "w1", "b1"], ["hidden"], transB=1),
        helper.make_node("Tanh", ["hidden"], ["bounded"]),
        helper.make_node("Gemm", ["bounded", "w2", "b2"], ["raw"], transB=1),
        helper.make_node("Tanh", ["raw"], ["action"]),
    ]
    graph = helper.make_graph(
        nodes,
        "to_the_exit",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["batch", OBSERVATION])],
        [helper.make_tensor_value_info("action", TensorProto.FLOAT, ["batch", 2])],
        [numpy_helper.from_array(values, name) for name, values in constants.items()],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    onnx.checker.check_model(model)
    Path(__file__).with_name("to_the_exit.onnx").write_bytes(model.SerializeToString())


if __name__ == "__main__":
    main()
