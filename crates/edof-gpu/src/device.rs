//! A device behind the system's OpenCL library: buffers, programs, launches. All that is unsafe here is in this file; what a kernel may touch is
//! checked against the sizes that it is given, in the kernel.

use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use opencl3::device::{CL_DEVICE_TYPE_ALL, CL_DEVICE_TYPE_GPU, get_all_devices};
use opencl3::error_codes::ClError;
use opencl3::kernel::{ExecuteKernel, Kernel};
use opencl3::memory::{Buffer as Memory, CL_MEM_READ_WRITE, ClMem};
use opencl3::program::Program;
use opencl3::types::{CL_BLOCKING, cl_device_id, cl_mem};
use std::ffi::c_void;
use std::marker::PhantomData;
use std::sync::Mutex;

/// What keeps a network from an accelerator.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum GpuError {
    /// No library or no device.
    #[error(
        "no device: {0}; install a driver for OpenCL (Debian: the maker's, or pocl-opencl-icd for the CPU)"
    )]
    NoDevice(String),
    /// A number that no device has.
    #[error("no device {wanted}: there are {found}, counted from 0")]
    NoSuchDevice { wanted: usize, found: usize },
    /// A call that the driver rejected.
    #[error("{device}: {what}: {reason}")]
    Driver { device: String, what: &'static str, reason: String },
    /// A device with too little memory.
    #[error("{device}: has {memory} bytes of memory, this frame needs {needed}")]
    Memory { device: String, memory: u64, needed: u64 },
    /// A frame whose pixels a kernel cannot count.
    #[error("frame of {0} pixels: a device takes less than 2^31")]
    TooManyPixels(usize),
    /// A network that could not run exactly.
    #[error(transparent)]
    FixedNetwork(#[from] edof_network::fixed_network::FixedNetworkError),
    /// Matrices that do not fit their form.
    #[error(transparent)]
    Network(#[from] edof_network::network::NetworkError),
    /// A frame that no network can take.
    #[error(transparent)]
    Geometry(#[from] edof_core::geometry::GeometryError),
}

/// A device that kernels can run on.
///
/// ```
/// match edof_gpu::Device::open(None) {
///     Ok(device) => println!("{}", device.name()),
///     Err(error) => assert!(error.to_string().starts_with("no device")),
/// }
/// ```
#[derive(Debug)]
pub struct Device {
    name: String,
    memory: u64,
    context: Context,
    queue: CommandQueue,
}

impl Device {
    /// Names of all devices, those that are GPUs first.
    ///
    /// # Errors
    /// [`GpuError::NoDevice`] without one.
    pub fn names() -> Result<Vec<String>, GpuError> {
        let name = |id| opencl3::device::Device::new(id).name().unwrap_or_default().trim().to_owned();
        Ok(ids()?.into_iter().map(name).collect())
    }

    /// Device `wanted` of [`Self::names`], or the first.
    ///
    /// # Errors
    /// [`GpuError::NoDevice`], [`GpuError::NoSuchDevice`] or [`GpuError::Driver`].
    pub fn open(wanted: Option<usize>) -> Result<Self, GpuError> {
        let ids = ids()?;
        let wanted = wanted.unwrap_or(0);
        let id = *ids.get(wanted).ok_or(GpuError::NoSuchDevice { wanted, found: ids.len() })?;
        let device = opencl3::device::Device::new(id);
        let name = device.name().unwrap_or_default().trim().to_owned();
        let refused = |what| refused(&name, what);
        let context = Context::from_device(&device).map_err(refused("opening it"))?;
        let queue = CommandQueue::create_default_with_properties(&context, 0, 0)
            .map_err(refused("opening a queue"))?;
        let memory = device.global_mem_size().unwrap_or(u64::MAX);
        Ok(Self { name, memory, context, queue })
    }

    /// What its driver calls it.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// # Errors
    /// [`GpuError::Memory`] if the device has less memory than that.
    pub(crate) fn check_memory(&self, needed: u64) -> Result<(), GpuError> {
        if needed <= self.memory {
            return Ok(());
        }
        Err(GpuError::Memory { device: self.name.clone(), memory: self.memory, needed })
    }

    /// Compiles OpenCL C.
    pub(crate) fn compile(&self, source: &str, options: &str) -> Result<Program, GpuError> {
        Program::create_and_build_from_source(&self.context, source, options).map_err(|log| {
            GpuError::Driver {
                device: self.name.clone(),
                what: "compiling the kernels",
                reason: log.lines().next().unwrap_or_default().to_owned(),
            }
        })
    }

    /// A buffer of `length` elements (at least one), of undefined contents.
    pub(crate) fn buffer<T: Element>(&self, length: usize) -> Result<Buffer<T>, GpuError> {
        let length = length.max(1);
        // SAFETY: no host memory is given, so that nothing has to outlive the buffer.
        let memory = unsafe {
            Memory::create(&self.context, CL_MEM_READ_WRITE, length, std::ptr::null_mut::<c_void>())
        };
        Ok(Buffer { memory: memory.map_err(refused(&self.name, "reserving memory"))?, length })
    }

    /// A buffer with these elements.
    pub(crate) fn upload<T: Element>(&self, data: &[T]) -> Result<Buffer<T>, GpuError> {
        let mut buffer = self.buffer(data.len())?;
        self.write(&mut buffer, data)?;
        Ok(buffer)
    }

    /// Writes the first elements of a buffer.
    pub(crate) fn write<T: Element>(&self, buffer: &mut Buffer<T>, data: &[T]) -> Result<(), GpuError> {
        assert!(data.len() <= buffer.length, "more elements than the buffer has");
        if data.is_empty() {
            return Ok(());
        }
        // SAFETY: the buffer is large enough, and the call returns when the driver has read all of `data`.
        let written =
            unsafe { self.queue.enqueue_write_buffer(&mut buffer.memory, CL_BLOCKING, 0, data, &[]) };
        written.map_err(refused(&self.name, "writing its memory")).map(drop)
    }

    /// The first elements of a buffer, as many as `data` has.
    pub(crate) fn read_into<T: Element>(&self, buffer: &Buffer<T>, data: &mut [T]) -> Result<(), GpuError> {
        assert!(data.len() <= buffer.length, "more elements than the buffer has");
        if data.is_empty() {
            return Ok(());
        }
        // SAFETY: the buffer holds as many elements, any bits are a number of these types, and the call returns when `data` is written.
        let read = unsafe { self.queue.enqueue_read_buffer(&buffer.memory, CL_BLOCKING, 0, data, &[]) };
        read.map_err(refused(&self.name, "reading its memory")).map(drop)
    }

    /// The first `length` elements of a buffer.
    pub(crate) fn read<T: Element>(&self, buffer: &Buffer<T>, length: usize) -> Result<Vec<T>, GpuError> {
        let mut data = vec![T::default(); length];
        self.read_into(buffer, &mut data)?;
        Ok(data)
    }

    /// Sets all elements of a buffer to zero.
    pub(crate) fn clear<T: Element>(&self, buffer: &mut Buffer<T>) -> Result<(), GpuError> {
        let size = buffer.length * size_of::<T>();
        // SAFETY: the size is the buffer's own, a whole number of patterns; the pattern is copied before the call returns.
        let filled =
            unsafe { self.queue.enqueue_fill_buffer(&mut buffer.memory, &[T::default()], 0, size, &[]) };
        filled.map_err(refused(&self.name, "clearing its memory")).map(drop)
    }

    /// Starts a kernel over `size` work-items, after all that was started before.
    pub(crate) fn launch(
        &self,
        program: &Program,
        kernel: &'static str,
        arguments: &[Argument<'_>],
        size: [usize; 2],
    ) -> Result<(), GpuError> {
        if size.contains(&0) {
            return Ok(());
        }
        let refused = || refused(&self.name, kernel);
        let kernel = Kernel::create(program, kernel).map_err(refused())?;
        let count = kernel.num_args().map_err(refused())? as usize;
        assert!(count == arguments.len(), "a kernel of {count} arguments was given {}", arguments.len());
        let mut launch = ExecuteKernel::new(&kernel);
        for argument in arguments {
            // SAFETY: the driver checks each argument's size, and copies it; a buffer stays alive until what was started has ended, as the
            // driver counts references.
            unsafe {
                match argument {
                    Argument::Number(number) => launch.set_arg(number),
                    Argument::Memory(memory, _) => launch.set_arg(memory),
                };
            }
        }
        launch.set_global_work_sizes(&size);
        // SAFETY: all arguments are set; what a kernel reads and writes lies within the sizes among them (tests run each one).
        unsafe { launch.enqueue_nd_range(&self.queue) }.map_err(refused()).map(drop)
    }
}

/// All devices, GPUs first. One thread asks at a time: a driver that another has just begun to start says that it has none.
fn ids() -> Result<Vec<cl_device_id>, GpuError> {
    static ASKING: Mutex<()> = Mutex::new(());
    let _asking = ASKING.lock();
    let none = |error: ClError| {
        let text = error.to_string();
        let no_library = text.contains("DLOPEN");
        GpuError::NoDevice(if no_library {
            "there is no OpenCL library (libOpenCL.so)".to_owned()
        } else {
            text
        })
    };
    let mut ids = get_all_devices(CL_DEVICE_TYPE_ALL).map_err(none)?;
    if ids.is_empty() {
        return Err(GpuError::NoDevice("the system's OpenCL library knows none".to_owned()));
    }
    let gpu = |id: &cl_device_id| {
        opencl3::device::Device::new(*id).dev_type().is_ok_and(|kind| kind & CL_DEVICE_TYPE_GPU != 0)
    };
    ids.sort_by_key(|id| !gpu(id));
    Ok(ids)
}

fn refused(device: &str, what: &'static str) -> impl FnOnce(ClError) -> GpuError {
    let device = device.to_owned();
    move |error| GpuError::Driver { device, what, reason: error.to_string() }
}

/// What a buffer may hold: numbers, of which any bits are one.
pub(crate) trait Element: Copy + Default {}
impl Element for i16 {}
impl Element for u16 {}
impl Element for i32 {}
impl Element for u32 {}
impl Element for f32 {}

/// Elements in a device's memory.
#[derive(Debug)]
pub(crate) struct Buffer<T> {
    memory: Memory<T>,
    length: usize,
}

/// What a kernel is given.
pub(crate) enum Argument<'a> {
    Number(i32),
    Memory(cl_mem, PhantomData<&'a ()>),
}

impl<'a, T> From<&'a Buffer<T>> for Argument<'a> {
    fn from(buffer: &'a Buffer<T>) -> Self {
        Self::Memory(buffer.memory.get(), PhantomData)
    }
}

impl From<usize> for Argument<'_> {
    /// Frames of 2³¹ pixels and more are rejected before.
    fn from(number: usize) -> Self {
        Self::Number(i32::try_from(number).unwrap_or(i32::MAX))
    }
}

impl From<isize> for Argument<'_> {
    fn from(number: isize) -> Self {
        Self::Number(i32::try_from(number).unwrap_or(i32::MIN))
    }
}

impl From<u32> for Argument<'_> {
    fn from(number: u32) -> Self {
        Self::from(number as usize)
    }
}

impl From<bool> for Argument<'_> {
    fn from(flag: bool) -> Self {
        Self::Number(flag.into())
    }
}
