//! Ctrl-C while Rust computes, and computing in a process that was forked.

use std::ops::ControlFlow;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyKeyboardInterrupt;
use rayon::{ThreadPool, ThreadPoolBuilder};
use viscocontact::Result;

use crate::errors::no_exception;
use crate::prelude::*;

/// Time between two looks for a signal.
const LISTEN: Duration = Duration::from_millis(50);

/// The one thread on which a process that was forked computes: the threads of its parent are not in it, and who waited for them would hang.
static OF_CHILD: Mutex<Option<Arc<ThreadPool>>> = Mutex::new(None);

/// Called in a process that was forked, for it and for its children.
#[pyfunction]
#[pyo3(name = "_forked")]
pub fn forked() {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().ok().map(Arc::new);
    // the threads of a pool before are not in this process, either: it has no end here
    std::mem::forget(std::mem::replace(&mut *OF_CHILD.lock().unwrap_or_else(PoisonError::into_inner), pool));
}

/// Computes without the GIL.
pub fn free<T: Send>(py: Python<'_>, job: impl FnOnce() -> T + Send) -> T {
    py.detach(|| on_own_threads(job))
}

fn on_own_threads<T: Send>(job: impl FnOnce() -> T + Send) -> T {
    let pool = OF_CHILD.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let Some(pool) = pool else { return job() };
    let (value, raised) = pool.install(|| (job(), no_exception()));
    raised_number(raised, ());
    value
}

/// Computes without the GIL. Python handles signals on the thread that called, so what is `slow` is computed on another one, while this
/// one listens, and sets the flag of the computation where a handler raises: KeyboardInterrupt comes out, after the call where the computation had come to its end. What
/// is not slow is computed at once.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    slow: bool,
    cancel: &AtomicBool,
    job: impl FnOnce() -> Result<T> + Send,
) -> PyResult<T> {
    // of a call before this one
    py.check_signals()?;
    if !slow {
        return free(py, job).or_raise();
    }
    py.detach(|| {
        thread::scope(|scope| {
            let (send, receive) = channel();
            let worker = scope.spawn(move || send.send((on_own_threads(job), no_exception())).is_ok());
            let mut raised = None;
            loop {
                match receive.recv_timeout(LISTEN) {
                    Ok((result, user)) => {
                        cancel.store(false, Ordering::Relaxed);
                        user?;
                        return match raised {
                            // what is done is done: the contact is where the result says, and the signal comes after the call
                            Some(raised) if result.is_ok() && is_ctrl_c(&raised) => signal_again().map(|()| result),
                            Some(raised) => Err(raised),
                            None => Ok(result),
                        };
                    }
                    Err(RecvTimeoutError::Disconnected) => {
                        let Err(panic) = worker.join() else { unreachable!("the result was sent") };
                        std::panic::resume_unwind(panic);
                    }
                    Err(RecvTimeoutError::Timeout) if raised.is_none() => {
                        raised = Python::attach(|py| py.check_signals()).err();
                        cancel.store(raised.is_some(), Ordering::Relaxed);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                }
            }
        })
    })?
    .or_raise()
}

fn is_ctrl_c(raised: &PyErr) -> bool {
    Python::attach(|py| raised.is_instance_of::<PyKeyboardInterrupt>(py))
}

/// Sends Ctrl-C once more, which Python handles when the call has returned.
fn signal_again() -> PyResult<()> {
    // signal.raise_signal would handle it at once
    Python::attach(|py| py.import("_thread")?.call_method0("interrupt_main").map(drop))
}

/// Listens for Ctrl-C, and to a report of progress that may end a call, between two problems.
pub struct Listener {
    progress: Option<Function>,
    raised: Option<PyErr>,
}

impl Listener {
    pub fn new(progress: Option<Function>) -> Listener {
        Listener { progress, raised: None }
    }

    pub fn goes_on(&mut self, done: impl for<'py> pyo3::call::PyCallArgs<'py>) -> ControlFlow<()> {
        let signals = Python::attach(|py| py.check_signals());
        match signals.and_then(|()| goes_on(self.progress.as_ref(), done)) {
            Ok(true) => ControlFlow::Continue(()),
            Ok(false) => ControlFlow::Break(()),
            Err(error) => {
                self.raised = Some(error);
                ControlFlow::Break(())
            }
        }
    }

    /// The result of the call, or what was raised meanwhile.
    pub fn result<T>(self, result: PyResult<T>) -> PyResult<T> {
        self.raised.map_or(result, Err)
    }
}
