//! What people use instead of the network: demosaicing, later deconvolution.
