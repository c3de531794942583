//! What a device makes is what the processor makes: every word and count of the fixed network, and the float network up to rounding.
//! Each needs a device and is ignored: `scripts/test-gpu.sh` installs one that runs on the processor if no device is present, and runs them.

use edof_core::camera::Camera;
use edof_core::draw::Draw;
use edof_core::overlap::Overlap;
use edof_core::{CfaPhase, RawFrame, Reconstructor, Stride, Window};
use edof_golden::Golden;
use edof_golden::fast::Fast;
use edof_gpu::{Device, GpuFloat, GpuGolden};
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use edof_network::network::{Form, Network, Origin, Recurrence, Shrinkage};
use ndarray::{Array1, Array2};

fn device() -> Device {
    Device::open(None).unwrap_or_else(|error| panic!("nothing to compare with: {error}"))
}

/// Eight forms that between them have every flag, shrinkage, window and kind of length.
fn forms() -> impl Iterator<Item = Form> {
    (0..8).map(|i| Form {
        window: Window::new([8, 12, 16][i % 3]).unwrap(),
        codes: [192, 33, 8, 61, 128, 1, 250, 100][i],
        layers: [4, 2, 10, 3, 5, 6, 4, 7][i],
        shrinkage: Shrinkage::ALL[i % Shrinkage::ALL.len()],
        recurrence: if i / 2 % 2 == 0 { Recurrence::Direct } else { Recurrence::Difference },
        linear_path: i % 3 != 1,
        tied: i / 4 == 1,
        exposures: 1,
    })
}

fn extreme_frame(draw: &mut Draw, height: usize, width: usize, phase: CfaPhase) -> RawFrame {
    let values = Array2::from_shape_fn((height, width), |_| draw.extreme(16) as u16);
    RawFrame::from_values(values, 16, phase).unwrap()
}

#[test]
#[ignore = "needs a device behind OpenCL: scripts/test-gpu.sh"]
fn every_boundary_of_extreme_windows_is_the_processors() {
    let draw = &mut Draw::new(1);
    for (i, form) in forms().enumerate() {
        let device = device();
        let bits = [16, 8, 12, 15][i % 4];
        let network = edof_device::random::extreme(form, bits, Stride::PATCH, i == 3, i as u64);
        let windows: Vec<_> =
            (0..70).flat_map(|_| edof_device::random::extreme_window(draw, form.window.pixels())).collect();
        let traces = GpuGolden::new(device, network.clone(), "").unwrap().traces(&windows).unwrap();
        for (patch, (here, there)) in traces.iter().zip(Fast::new(network).traces(&windows)).enumerate() {
            assert_eq!(*here, there, "{form:?}, patch {patch}");
        }
    }
}

#[test]
#[ignore = "needs a device behind OpenCL: scripts/test-gpu.sh"]
fn frames_of_every_phase_and_stride_are_the_processors() {
    let draw = &mut Draw::new(2);
    for (i, form) in forms().enumerate() {
        let device = device();
        let stride = Stride::new([2, 4, 8][(i + 1) % 3]).unwrap();
        let network = edof_device::random::extreme(form, 16, stride, false, i as u64);
        let raw = extreme_frame(draw, 18 + 2 * i, 46 - 2 * i, CfaPhase::ALL[i % 4]);
        let there = Golden::new(network.clone()).unwrap().frame(&raw).unwrap();
        assert_eq!(GpuGolden::new(device, network, "").unwrap().frame(&raw).unwrap(), there, "{form:?}");
    }
}

/// More rows of patches than go through the network at once.
#[test]
#[ignore = "needs a device behind OpenCL: scripts/test-gpu.sh"]
fn a_frame_in_several_lots_has_no_seams() {
    let device = device();
    let network = edof_device::random::natural(8, 2, 3);
    let raw = extreme_frame(&mut Draw::new(3), 130, 640, CfaPhase::Rggb);
    let there = Golden::new(network.clone()).unwrap().frame(&raw).unwrap();
    assert_eq!(GpuGolden::new(device, network, "").unwrap().frame(&raw).unwrap(), there);
}

/// The device's memory is kept from frame to frame, of one size.
#[test]
#[ignore = "needs a device behind OpenCL: scripts/test-gpu.sh"]
fn a_frame_leaves_nothing_behind_for_the_next() {
    let (draw, stride) = (&mut Draw::new(5), Stride::new(4).unwrap());
    let form = forms().next().unwrap();
    let fixed = edof_device::random::extreme(form, 16, stride, false, 5);
    let golden = Golden::new(fixed.clone()).unwrap();
    let fixed = GpuGolden::new(device(), fixed, "").unwrap();
    let network = float_network(form, draw);
    let new_float = || GpuFloat::new(device(), network.clone(), stride, Overlap::Hann).unwrap();
    let float = new_float();
    for (height, width) in [(32, 48), (32, 48), (40, 32), (32, 48)] {
        let raw = extreme_frame(draw, height, width, CfaPhase::Rggb);
        assert_eq!(fixed.frame(&raw).unwrap(), golden.frame(&raw).unwrap(), "{height}x{width}");
        assert_eq!(float.frame(&raw).unwrap(), new_float().frame(&raw).unwrap(), "{height}x{width}");
    }
}

#[test]
#[ignore = "needs a device behind OpenCL: scripts/test-gpu.sh"]
fn the_float_network_is_the_processors_up_to_the_order_of_its_sums() {
    let draw = &mut Draw::new(4);
    for (i, form) in forms().enumerate() {
        let device = device();
        let network = float_network(form, draw);
        let stride = Stride::new([8, 4, 2][i % 3]).unwrap();
        let raw = extreme_frame(draw, 40, 64, CfaPhase::ALL[i % 4]);
        let reference = FloatReconstructor::new(network.clone(), stride, Overlap::Hann, Output::Rgb).unwrap();
        let there = reference.reconstruct(&raw).unwrap().frame.planes;
        let here = GpuFloat::new(device, network, stride, Overlap::Hann).unwrap().frame(&raw).unwrap().planes;
        let largest = there.iter().fold(0f32, |max, v| max.max(v.abs()));
        let error = (&here - &there).iter().fold(0f32, |max, v| max.max(v.abs()));
        assert!(largest > 0.0 && error <= 2e-6 * largest, "{form:?}: {error} of {largest}");
    }
}

/// Small weights of both signs, so that sums neither vanish nor grow from layer to layer.
fn float_network(form: Form, draw: &mut Draw) -> Network {
    let (codes, pixels) = (form.codes, form.window.pixels());
    let mut matrix = |rows: usize, columns: usize| {
        let scale = (columns as f32).sqrt().recip() / 1000.0;
        Array2::from_shape_fn((rows, columns), |_| draw.whole(-1000, 1000) as f32 * scale)
    };
    Network {
        form,
        analysis: matrix(codes, pixels),
        thresholds: (0..form.shrinkages()).map(|_| Array1::from_elem(codes, 0.02)).collect(),
        recurrent: (0..form.recurrent_matrices()).map(|_| matrix(codes, codes)).collect(),
        dictionary: matrix(192, codes),
        linear_path: form.linear_path.then(|| matrix(192, pixels)),
        origin: Origin::untrained("drawn", Camera::resolve("ring-2018").unwrap()),
    }
}

#[test]
#[ignore = "needs a device behind OpenCL: scripts/test-gpu.sh"]
fn a_frame_that_no_window_fits_and_a_device_that_is_not_there_are_named() {
    let device = device();
    let gpu = GpuGolden::new(device, edof_device::random::natural(8, 8, 1), "net").unwrap();
    let small = RawFrame::from_values(Array2::zeros((8, 8)), 8, CfaPhase::Rggb).unwrap();
    let error = gpu.reconstruct(&small).unwrap_err().to_string();
    assert_eq!(error, "frame 8x8: both sides must be at least 10 pixels for a window of 8");
    let error = Device::open(Some(99)).unwrap_err().to_string();
    assert_eq!(error, format!("no device 99: there are {}, counted from 0", Device::names().unwrap().len()));
}
