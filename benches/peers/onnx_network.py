"""The float network as a graph for ONNX Runtime."""

import numpy as np
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

STRIDE = 8


def graph(weights, height, width, convolve, threads):
    """The network as ONNX: on a padded raw frame by convolutions, or on rows of windows by matrix products."""
    nodes, constants = [], []

    def constant(name, value):
        constants.append(numpy_helper.from_array(np.ascontiguousarray(value, dtype=np.float32), name))
        return name

    def node(op, inputs, output, **attributes):
        nodes.append(helper.make_node(op, inputs, [output], **attributes))
        return output

    def product(of, matrix, output):
        w = weights[matrix]
        if not convolve:
            return node("MatMul", [of, constant(matrix, w.T)], output)
        side = int(w.shape[1] ** 0.5) if of == "y" else 1
        kernel = w.reshape(len(w), -1, side, side)
        step = STRIDE if of == "y" else 1
        return node("Conv", [of, constant(matrix, kernel)], output, kernel_shape=[side, side], strides=[step, step])

    def shrink(b, t):
        theta = weights[f"threshold.{t}"].reshape((1, -1, 1, 1) if convolve else (1, -1))
        return node("Relu", [node("Sub", [b, constant(f"theta{t}", theta)], f"b{t}-theta")], f"z{t}")

    b = first = product("y", "analysis", "b")
    middle = sum(name.startswith("recurrent") for name in weights)
    for t in range(middle):
        b = node("Add", [first, product(shrink(b, t), f"recurrent.{t}", f"s{t}")], f"b{t + 1}")
    out = node("Add", [product(shrink(b, middle), "dictionary", "d"), product("y", "linear_path", "r")], "patches")
    if convolve:
        out = node("DepthToSpace", [out], "picture", blocksize=STRIDE, mode="CRD")
    margin = int(weights["analysis"].shape[1] ** 0.5) - STRIDE
    shape = [1, 1, height + margin, width + margin] if convolve else ["patches", weights["analysis"].shape[1]]
    y = helper.make_tensor_value_info("y", TensorProto.FLOAT, shape)
    result = helper.make_tensor_value_info(out, TensorProto.FLOAT, None)
    model = helper.make_model(
        helper.make_graph(nodes, "network", [y], [result], constants),
        opset_imports=[helper.make_opsetid("", 17)],
        ir_version=8,
    )
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    return onnxruntime.InferenceSession(model.SerializeToString(), options, providers=["CPUExecutionProvider"])
