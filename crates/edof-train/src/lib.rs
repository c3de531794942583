//! The float network: forward, gradient, training, quantization.
