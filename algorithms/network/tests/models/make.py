"""Write the models of the tests, and what ONNX Runtime computes with them.

    pip install onnx onnxruntime numpy
    python make.py

Each model has its inputs and outputs in `values.json`.
"""

import json
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

FOLDER = Path(__file__).parent
RANDOM = np.random.default_rng(32)


def constant(name, values, dtype=np.float32):
    return numpy_helper.from_array(np.asarray(values, dtype), name)


def normal(name, *shape):
    return constant(name, RANDOM.normal(0.0, 0.5, shape))


def model(nodes, constants, inputs, outputs, opset):
    """A model with one input and one output; a shape may contain a name."""
    kind = TensorProto.FLOAT
    graph = helper.make_graph(
        nodes,
        "test",
        [helper.make_tensor_value_info("x", kind, inputs)],
        [helper.make_tensor_value_info("y", kind, outputs)],
        constants,
    )
    made = helper.make_model(graph, opset_imports=[helper.make_opsetid("", opset)], ir_version=8)
    onnx.checker.check_model(made)
    return made


def policy():
    """A policy as PyTorch exports it: normalised observations, two hidden layers, bounded actions."""
    nodes = [
        helper.make_node("Sub", ["x", "mean"], ["centred"]),
        helper.make_node("Div", ["centred", "spread"], ["scaled"]),
        helper.make_node("Clip", ["scaled", "low", "high"], ["clipped"]),
        helper.make_node("Gemm", ["clipped", "w1", "b1"], ["a1"], transB=1),
        helper.make_node("Tanh", ["a1"], ["h1"]),
        helper.make_node("Gemm", ["h1", "w2", "b2"], ["a2"], transB=1, alpha=0.5, beta=2.0),
        helper.make_node("Relu", ["a2"], ["h2"]),
        helper.make_node("MatMul", ["h2", "w3"], ["a3"]),
        helper.make_node("Add", ["a3", "b3"], ["a4"]),
        helper.make_node("Tanh", ["a4"], ["y"]),
    ]
    constants = [
        normal("mean", 7),
        constant("spread", RANDOM.uniform(0.5, 2.0, 7)),
        constant("low", -5.0),
        constant("high", 5.0),
        normal("w1", 16, 7),
        normal("b1", 16),
        normal("w2", 12, 16),
        normal("b2", 12),
        normal("w3", 12, 2),
        normal("b3", 2),
    ]
    return model(nodes, constants, ["batch", 7], ["batch", 2], 17)


def operators():
    """Every operator that `policy` lacks, and every form of broadcasting."""
    nodes = [
        helper.make_node("Constant", [], ["shape"], value=constant("", [2, -1], np.int64)),
        helper.make_node("Reshape", ["x", "shape"], ["matrix"]),
        helper.make_node("Mul", ["matrix", "column"], ["by_row"]),
        helper.make_node("Sub", ["row", "by_row"], ["turned"]),
        helper.make_node("Sigmoid", ["turned"], ["soft"]),
        helper.make_node("Sin", ["matrix"], ["sine"]),
        helper.make_node("Cos", ["by_row"], ["cosine"]),
        helper.make_node("Add", ["sine", "cosine"], ["wave"]),
        helper.make_node("Concat", ["soft", "wave"], ["wide"], axis=-1),
        helper.make_node("Concat", ["wide", "wide"], ["tall"], axis=0),
        helper.make_node("MatMul", ["tall", "weights"], ["product"]),
        helper.make_node("Flatten", ["product"], ["flat"], axis=0),
        helper.make_node("Clip", ["flat", "low"], ["bounded"]),
        helper.make_node("Identity", ["bounded"], ["y"]),
    ]
    constants = [
        normal("column", 2, 1),
        normal("row", 3),
        normal("weights", 6, 2),
        constant("low", -0.25),
    ]
    return model(nodes, constants, [6], [1, 8], 13)


def old():
    """The oldest set of operators: bounds as attributes, values as lists."""
    weights = helper.make_tensor("w", TensorProto.FLOAT, [4, 3], RANDOM.normal(0.0, 1.0, 12))
    nodes = [
        helper.make_node("Gemm", ["x", "w", "b"], ["a"]),
        helper.make_node("Clip", ["a"], ["y"], min=-1.0, max=1.0),
    ]
    return model(nodes, [weights, normal("b", 1, 3)], [1, 4], [1, 3], 7)


def main():
    values = {}
    for make in (policy, operators, old):
        name = make.__name__
        made = make()
        (FOLDER / f"{name}.onnx").write_bytes(made.SerializeToString())
        session = onnxruntime.InferenceSession(made.SerializeToString())
        shape = [1 if isinstance(n, str) else n for n in session.get_inputs()[0].shape]
        inputs = RANDOM.normal(0.0, 1.5, (8, *shape)).astype(np.float32)
        outputs = [session.run(None, {"x": x})[0] for x in inputs]
        values[name] = [
            {"input": x.ravel().tolist(), "output": y.ravel().tolist()}
            for x, y in zip(inputs, outputs, strict=True)
        ]
    text = json.dumps(values, indent=0) + "\n"
    (FOLDER / "values.json").write_text(text)


if __name__ == "__main__":
    main()
