"""A ROS 2 robot as an environment: transports, wheel guard, synchronised sensors, closed-loop primitives."""
