"""A robot that is not there: a differential-drive base and its sensors in any world, behind the transports of a real one."""
