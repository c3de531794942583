//! Matrix products of the trainer's shapes, one thread, in three crates. Prints GFLOP/s, the median of 15 runs.
//!
//! `cargo run --release --manifest-path benches/gemm/Cargo.toml`

use std::time::Instant;

/// One product C (m×n) = A (m×k) · B (k×n), each with (row, column) strides.
struct Shape {
    what: &'static str,
    m: usize,
    k: usize,
    n: usize,
    a: (isize, isize),
    b: (isize, isize),
}

fn main() {
    let batch = 256;
    let (codes, pixels, outputs) = (192, 144, 192);
    let row = |columns: usize| (columns as isize, 1);
    let transposed = |columns: usize| (1, columns as isize);
    let shapes = [
        Shape { what: "b = y Aᵀ", m: batch, k: pixels, n: codes, a: row(pixels), b: transposed(pixels) },
        Shape { what: "b = z Sᵀ", m: batch, k: codes, n: codes, a: row(codes), b: transposed(codes) },
        Shape { what: "dz = db S", m: batch, k: codes, n: codes, a: row(codes), b: row(codes) },
        Shape { what: "dS = dbᵀ z", m: codes, k: batch, n: codes, a: transposed(codes), b: row(codes) },
        Shape { what: "dR = eᵀ y", m: outputs, k: batch, n: pixels, a: transposed(outputs), b: row(pixels) },
    ];
    println!("{:<12} {:>10} {:>10} {:>14}", "product", "gemm", "faer", "matrixmultiply");
    for shape in &shapes {
        let rates = [with_gemm, with_faer, with_matrixmultiply].map(|product| rate(shape, product));
        println!("{:<12} {:>10.0} {:>10.0} {:>14.0}", shape.what, rates[0], rates[1], rates[2]);
    }
}

type Product = fn(&Shape, &[f32], &[f32], &mut [f32]);

fn rate(shape: &Shape, product: Product) -> f64 {
    let noise = |length: usize| (0..length).map(|i| (i * 7919 % 1013) as f32 / 1013.0 - 0.5).collect::<Vec<f32>>();
    let (a, b) = (noise(shape.m * shape.k), noise(shape.k * shape.n));
    let mut c = vec![0.0; shape.m * shape.n];
    let mut times: Vec<f64> = (0..15)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..50 {
                product(shape, &a, &b, &mut c);
            }
            start.elapsed().as_secs_f64() / 50.0
        })
        .collect();
    times.sort_by(f64::total_cmp);
    2.0 * (shape.m * shape.k * shape.n) as f64 / times[7] / 1e9
}

fn with_gemm(s: &Shape, a: &[f32], b: &[f32], c: &mut [f32]) {
    // SAFETY: the slices hold m×k, k×n and m×n numbers, which the strides address exactly.
    unsafe {
        gemm::gemm(
            s.m, s.n, s.k, c.as_mut_ptr(), 1, s.n as isize, false, a.as_ptr(), s.a.1, s.a.0, b.as_ptr(), s.b.1,
            s.b.0, 0.0, 1.0, false, false, false, gemm::Parallelism::None,
        );
    }
}

fn with_faer(s: &Shape, a: &[f32], b: &[f32], c: &mut [f32]) {
    use faer::{Accum, MatMut, MatRef, Par, linalg::matmul::matmul};
    // SAFETY: as in `with_gemm`.
    unsafe {
        let a = MatRef::from_raw_parts(a.as_ptr(), s.m, s.k, s.a.0, s.a.1);
        let b = MatRef::from_raw_parts(b.as_ptr(), s.k, s.n, s.b.0, s.b.1);
        let c = MatMut::from_raw_parts_mut(c.as_mut_ptr(), s.m, s.n, s.n as isize, 1);
        matmul(c, Accum::Replace, a, b, 1.0f32, Par::Seq);
    }
}

fn with_matrixmultiply(s: &Shape, a: &[f32], b: &[f32], c: &mut [f32]) {
    // SAFETY: as in `with_gemm`.
    unsafe {
        matrixmultiply::sgemm(
            s.m, s.k, s.n, 1.0, a.as_ptr(), s.a.0, s.a.1, b.as_ptr(), s.b.0, s.b.1, 0.0, c.as_mut_ptr(),
            s.n as isize, 1,
        );
    }
}
