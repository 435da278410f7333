"""What all tests need."""

import signal

# a process in the background ignores Ctrl-C: tests of it would not end
signal.signal(signal.SIGINT, signal.default_int_handler)
